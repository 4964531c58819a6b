// SPDX-License-Identifier: Apache-2.0
// How far a predicted picture of an object is from the recorded one: the measures of PhysTwin's
// evaluate_render.py, but LPIPS, which needs the weights of a network.
//
// Both pictures show the object alone, on black, and are black where something hides it. Colours
// are from 0 to 1.
#ifndef PHYSPRING_PICTURES_IMAGE_ERRORS_H_
#define PHYSPRING_PICTURES_IMAGE_ERRORS_H_

#include <optional>
#include <vector>

#include "pictures/image.h"

namespace physpring {

// [begin, end) of columns and rows.
struct PixelBox {
  int left = 0, top = 0, right = 0, bottom = 0;

  bool empty() const { return left >= right || top >= bottom; }
};

// 10 log10(1 / mean squared difference) [dB] over all pixels of the box and channels; at most
// kMostPsnr, which no difference has.
constexpr double kMostPsnr = 100;
double Psnr(const Image& one, const Image& other, const PixelBox& box);

// Structural similarity (Wang et al. 2004), the mean over pixels of the box and channels: a
// Gaussian window of 11 x 11 pixels, deviation 1.5, C1 = 0.01^2, C2 = 0.03^2, variances over the
// window's weights, black beyond the picture. As scikit-image with gaussian_weights, sigma 1.5,
// data_range 1 and use_sample_covariance off.
double Ssim(const Image& one, const Image& other, const PixelBox& box);

struct ImageErrors {
  double iou = 0;                     // of the masks: common pixels by pixels of either
  double psnr = 0, ssim = 0;          // over the whole picture, most of which is black
  double box_psnr = 0, box_ssim = 0;  // over the box around the recorded object
};

// `coverage`: by pixel, from 0 to 1, how much the predicted object hides what is behind it. Its
// mask is where that is a half or more. (PhysTwin's has all that is not 0.) None where the object
// is not seen in what was recorded: nothing can be said then.
std::optional<ImageErrors> CompareImages(const Image& predicted, const std::vector<float>& coverage,
                                         const Image& recorded, const Mask& mask);

// The picture, black where the mask is not the object.
Image ObjectAlone(const Image& image, const Mask& mask);

// The picture, black where the mask says that the object is hidden.
Image WithoutHidden(const Image& image, const Mask& mask);

// Around all pixels that are not black in both.
PixelBox BoxNotBlack(const Image& one, const Image& other);

// Around all pixels of the object; empty if there is none.
PixelBox BoxOf(const Mask& mask);

}  // namespace physpring

#endif  // PHYSPRING_PICTURES_IMAGE_ERRORS_H_

// SPDX-License-Identifier: Apache-2.0
#include "splats/fit/splat_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "splats/fit/picture_loss.h"
#include "splats/fit/surface_start.h"
#include "splats/picture_bytes.h"
#include "splats/rasterise.h"
#include "trainer/solvers/adam.h"
#include "twin/error.h"
#include "twin/stop_request.h"

namespace physpring {
namespace {

// What a camera saw of the object.
struct Target {
  PinholeCamera view;
  Image image;  // the object alone, on black
  Mask mask;

  // The loss of one pixel, and its derivatives.
  double At(std::size_t place, const Pixel& pixel, Pixel* bar) const {
    constexpr double kByte = 255;
    if (mask.kind[place] == kHidden) return 0;
    const unsigned char* rgb = &image.rgb[3 * place];
    const Eigen::Vector3d off = pixel.colour - Eigen::Vector3d(rgb[0], rgb[1], rgb[2]) / kByte;
    const double uncovered = pixel.coverage - (mask.kind[place] == kObject ? 1 : 0);
    bar->colour = 2 * off;
    bar->coverage = 2 * uncovered;
    return off.squaredNorm() + uncovered * uncovered;
  }
};

std::vector<Target> ReadTargets(const PictureFolder& pictures, int frame) {
  std::vector<Target> targets;
  for (std::size_t i = 0; i < pictures.cameras().size(); ++i) {
    const int camera = static_cast<int>(i);
    Mask mask = pictures.ReadObjectMask(camera, frame);
    Image image = ObjectAlone(pictures.ReadImage(camera, frame), mask);
    targets.push_back({pictures.cameras()[i].view, std::move(image), std::move(mask)});
  }
  return targets;
}

double ObjectPixels(const std::vector<Target>& targets) {
  std::ptrdiff_t count = 0;
  for (const Target& target : targets) {
    count += std::count(target.mask.kind.begin(), target.mask.kind.end(), kObject);
  }
  return static_cast<double>(count);
}

// How far Adam moves each number in a step.
FreeSplats Rates(Eigen::Index count, double spacing) {
  FreeSplats rates(FreeSplats::RowsAtCompileTime, count);
  rates.middleRows<3>(kFreePosition).setConstant(0.02 * spacing);
  rates.middleRows<3>(kFreeScale).setConstant(0.02);
  rates.middleRows<4>(kFreeRotation).setConstant(0.01);
  rates.row(kFreeLogit).setConstant(0.05);
  rates.middleRows<3>(kFreeColour).setConstant(0.015);
  return rates;
}

void KeepWithin(double spacing, FreeSplats* splats) {
  constexpr double kThinnest = 0.1, kWidest = 1.5;  // spacings
  constexpr double kMostLogit = 6;
  auto scales = splats->middleRows<3>(kFreeScale);
  scales = scales.cwiseMax(std::log(kThinnest * spacing)).cwiseMin(std::log(kWidest * spacing));
  auto logits = splats->row(kFreeLogit);
  logits = logits.cwiseMax(-kMostLogit).cwiseMin(kMostLogit);
  auto colours = splats->middleRows<3>(kFreeColour);
  colours = colours.cwiseMax(0).cwiseMin(1);
}

}  // namespace

SplatFit FitSplats(const PictureFolder& pictures, const SplatFitOptions& options) {
  if (options.frame < 0 || options.frame >= pictures.frame_count()) {
    throw Error(fmt::format("{}: has no frame {}; its last is {}", pictures.path(), options.frame,
                            pictures.frame_count() - 1));
  }
  const std::vector<Target> all = ReadTargets(pictures, options.frame);
  std::vector<int> cameras = options.cameras;
  for (std::size_t i = 0; options.cameras.empty() && i < all.size(); ++i) {
    cameras.push_back(static_cast<int>(i));
  }
  std::vector<Target> targets;
  for (const int camera : cameras) targets.push_back(all[camera]);
  SurfaceStart start = StartOnSurface(pictures, cameras, options.frame, options.count);
  FreeSplats& splats = start.splats;
  const double pixels = ObjectPixels(targets);
  const auto loss_at = [&](FreeSplats* gradient) {
    gradient->setZero(FreeSplats::RowsAtCompileTime, splats.cols());
    double loss = 0;
    for (const Target& target : targets) {
      loss += AddPictureLoss(
          splats, target.view,
          [&target](std::size_t place, const Pixel& pixel, Pixel* bar) {
            return target.At(place, pixel, bar);
          },
          options.threads, gradient);
    }
    *gradient /= pixels;
    return loss / pixels;
  };

  SplatFit fit;
  fit.spacing = start.spacing;
  const FreeSplats rates = Rates(splats.cols(), start.spacing);
  Adam adam(splats.size());
  FreeSplats gradient;
  for (int i = 0; i < options.iterations; ++i) {
    StopIfRequested();
    fit.loss = loss_at(&gradient);
    if (i == 0) fit.first_loss = fit.loss;
    if (options.progress) options.progress(i, fit.loss);
    const double share = static_cast<double>(i) / options.iterations;
    const double slower = 0.55 + 0.45 * std::cos(std::numbers::pi * share);  // 1 to a tenth
    Eigen::VectorXd values = splats.reshaped();
    adam.Step(gradient.reshaped(), slower * rates.reshaped(), &values);
    splats = values.reshaped(splats.rows(), splats.cols());
    KeepWithin(start.spacing, &splats);
  }
  fit.loss = loss_at(&gradient);
  if (options.iterations == 0) fit.first_loss = fit.loss;
  fit.splats = StoredSplats(splats);
  const PlacedSplats placed = AsStored(fit.splats);
  for (const Target& target : all) {
    const SplatPicture picture = Rasterise(placed, target.view, {}, options.threads);
    fit.errors.push_back(
        CompareImages(BytesOf(picture), picture.coverage, target.image, target.mask));
  }
  return fit;
}

}  // namespace physpring

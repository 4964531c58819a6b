// SPDX-License-Identifier: Apache-2.0
// Splats: 3-D Gaussians that together look like an object or a scene (Kerbl et al. 2023, "3D
// Gaussian Splatting for Real-Time Radiance Field Rendering"). A splat is a cloud of colour about a
// place: its opacity falls off as exp(-d^T S^-1 d / 2), d from its place, S its covariance.
#ifndef PHYSPRING_SPLATS_SPLATS_H_
#define PHYSPRING_SPLATS_SPLATS_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>

namespace physpring {

constexpr int kMostHarmonicDegree = 3;

// How many spherical harmonics there are up to a degree.
constexpr int HarmonicCount(int degree) { return (degree + 1) * (degree + 1); }

// As they are trained and stored. One column a splat.
struct Splats {
  Eigen::Matrix3Xf position;   // m
  Eigen::Matrix3Xf log_scale;  // of the standard deviation along each own axis [log m]
  Eigen::Matrix4Xf rotation;   // w x y z, of the own axes; any length but 0
  Eigen::VectorXf logit;       // opacity = 1 / (1 + exp(-logit))
  int degree = 0;              // of the harmonics
  Eigen::MatrixXf harmonics;   // 3 HarmonicCount(degree): red of each, green of each, blue of each

  int count() const { return static_cast<int>(position.cols()); }
  // Makes room for `count` splats with harmonics up to `degree`; no number is set.
  void Resize(int count, int degree);
};

// Splats in a moment: where they are, how they are stretched, and how they are turned.
struct PlacedSplats {
  const Splats* look = nullptr;                        // lives longer: opacities and harmonics
  Eigen::Matrix3Xf position;                           // m
  Eigen::Matrix<float, 6, Eigen::Dynamic> covariance;  // xx xy xz yy yz zz, m^2
  // From the axes of `look` to the present ones, column by column; none: not turned. Colours are
  // those of the direction that is turned back.
  Eigen::Matrix<float, 9, Eigen::Dynamic> turn;

  Eigen::Matrix3f Covariance(int i) const;
  void SetCovariance(int i, const Eigen::Matrix3f& s) {
    covariance.col(i) << s(0, 0), s(0, 1), s(0, 2), s(1, 1), s(1, 2), s(2, 2);
  }
};

// Splats that are seen together.
using SplatGroups = std::span<const PlacedSplats* const>;

// As they are stored: S = R diag(exp(2 log_scale)) R^T.
PlacedSplats AsStored(const Splats& splats);

}  // namespace physpring

#endif  // PHYSPRING_SPLATS_SPLATS_H_

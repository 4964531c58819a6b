// SPDX-License-Identifier: Apache-2.0
#include "splats/fit/free_ellipse.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "splats/projection.h"

namespace physpring {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector4d;
using Jacobian = Eigen::Matrix<double, 2, 3>;

Matrix3d RotationOf(const Vector4d& q) {  // unit
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
}

// With respect to the quaternion (w x y z, any length), of what `bar` is with respect to its
// rotation.
Vector4d RotationAdjoint(const Vector4d& quaternion, const Matrix3d& bar) {
  const double norm = quaternion.norm();
  const Vector4d n = quaternion / norm;
  const double w = n[0], x = n[1], y = n[2], z = n[3];
  Vector4d unit;
  unit[0] = z * (bar(1, 0) - bar(0, 1)) + y * (bar(0, 2) - bar(2, 0)) + x * (bar(2, 1) - bar(1, 2));
  unit[1] = y * (bar(0, 1) + bar(1, 0)) + z * (bar(0, 2) + bar(2, 0)) +
            w * (bar(2, 1) - bar(1, 2)) - 2 * x * (bar(1, 1) + bar(2, 2));
  unit[2] = x * (bar(0, 1) + bar(1, 0)) + z * (bar(1, 2) + bar(2, 1)) +
            w * (bar(0, 2) - bar(2, 0)) - 2 * y * (bar(0, 0) + bar(2, 2));
  unit[3] = x * (bar(0, 2) + bar(2, 0)) + y * (bar(1, 2) + bar(2, 1)) +
            w * (bar(1, 0) - bar(0, 1)) - 2 * z * (bar(0, 0) + bar(1, 1));
  return 2 * (unit - n * n.dot(unit)) / norm;
}

// What both directions need of a splat before a camera.
struct View {
  Vector3d t;                 // in the camera
  double x, y;                // tangents, kept within
  bool x_is_free, y_is_free;  // whether they are t's own
  Matrix3d rotation;
  Vector3d variance;    // along the own axes
  Matrix3d covariance;  // S
  Jacobian derivative;  // J
  Jacobian m;           // J W
  Matrix2d inverse;     // S2^-1
  double xx, yy;        // of S2

  View(const FreeSplat& splat, const PinholeCamera& camera)
      : t(camera.axes * splat.segment<3>(kFreePosition) + camera.shift) {
    x = std::clamp(t.x() / t.z(), -kBeyond * camera.cx / camera.fx,
                   kBeyond * (camera.width - camera.cx) / camera.fx);
    y = std::clamp(t.y() / t.z(), -kBeyond * camera.cy / camera.fy,
                   kBeyond * (camera.height - camera.cy) / camera.fy);
    x_is_free = x == t.x() / t.z();
    y_is_free = y == t.y() / t.z();
    rotation = RotationOf(splat.segment<4>(kFreeRotation).normalized());
    variance = (2 * splat.segment<3>(kFreeScale)).array().exp();
    covariance = rotation * variance.asDiagonal() * rotation.transpose();
    derivative << camera.fx / t.z(), 0, -camera.fx * x / t.z(),  //
        0, camera.fy / t.z(), -camera.fy * y / t.z();
    m = derivative * camera.axes;
    const Matrix2d s2 = m * covariance * m.transpose() + kBlur * Matrix2d::Identity();
    inverse = s2.inverse();
    xx = s2(0, 0);
    yy = s2(1, 1);
  }
};

// Adds to the derivative with respect to t what J's is.
void DerivativeAdjoint(const View& view, const PinholeCamera& camera, const Jacobian& bar,
                       Vector3d* t_bar) {
  const double z = view.t.z();
  const double x_bar = -camera.fx / z * bar(0, 2), y_bar = -camera.fy / z * bar(1, 2);
  (*t_bar)[2] += (camera.fx * (view.x * bar(0, 2) - bar(0, 0)) +
                  camera.fy * (view.y * bar(1, 2) - bar(1, 1))) /
                 (z * z);
  if (view.x_is_free) *t_bar += x_bar / z * Vector3d(1, 0, -view.x);
  if (view.y_is_free) *t_bar += y_bar / z * Vector3d(0, 1, -view.y);
}

}  // namespace

void EllipseNumbers::operator+=(const EllipseNumbers& other) {
  u += other.u;
  v += other.v;
  a += other.a;
  b += other.b;
  c += other.c;
  opacity += other.opacity;
  colour += other.colour;
}

bool ProjectFree(const FreeSplat& splat, const PinholeCamera& camera, FreeEllipse* ellipse) {
  const View view(splat, camera);
  const double z = view.t.z();
  if (!(z > kNearest)) return false;
  FreeEllipse& e = *ellipse;
  e.depth = z;
  e.opacity = 1 / (1 + std::exp(-splat[kFreeLogit]));
  if (!(e.opacity >= kFaintest)) return false;
  e.cutoff = std::log(e.opacity / kFaintest);
  e.u = camera.fx * view.t.x() / z + camera.cx;
  e.v = camera.fy * view.t.y() / z + camera.cy;
  e.a = view.inverse(0, 0);
  e.b = view.inverse(0, 1);
  e.c = view.inverse(1, 1);
  e.colour = splat.segment<3>(kFreeColour).cwiseMax(0);
  const double half_width = std::sqrt(2 * e.cutoff * view.xx);
  const double half_height = std::sqrt(2 * e.cutoff * view.yy);
  e.box = {static_cast<float>(e.u), static_cast<float>(e.v), static_cast<float>(half_width),
           static_cast<float>(half_height)};
  return e.u + half_width > 0 && e.u - half_width < camera.width && e.v + half_height > 0 &&
         e.v - half_height < camera.height;
}

void ProjectFreeAdjoint(const FreeSplat& splat, const PinholeCamera& camera,
                        const EllipseNumbers& bar, Eigen::Ref<FreeSplat> splat_bar) {
  const View view(splat, camera);
  const double z = view.t.z();
  Matrix2d inverse_bar;
  inverse_bar << bar.a, bar.b / 2, bar.b / 2, bar.c;
  const Matrix2d s2_bar = -view.inverse * inverse_bar * view.inverse;
  const Jacobian m_bar = 2 * s2_bar * view.m * view.covariance;
  Vector3d t_bar(camera.fx / z * bar.u, camera.fy / z * bar.v,
                 -(camera.fx * view.t.x() * bar.u + camera.fy * view.t.y() * bar.v) / (z * z));
  DerivativeAdjoint(view, camera, m_bar * camera.axes.transpose(), &t_bar);
  splat_bar.segment<3>(kFreePosition) += camera.axes.transpose() * t_bar;

  const Matrix3d covariance_bar = view.m.transpose() * s2_bar * view.m;
  const Matrix3d spread = covariance_bar * view.rotation;
  for (int k = 0; k < 3; ++k) {
    splat_bar[kFreeScale + k] += 2 * view.variance[k] * view.rotation.col(k).dot(spread.col(k));
  }
  splat_bar.segment<4>(kFreeRotation) +=
      RotationAdjoint(splat.segment<4>(kFreeRotation), 2 * spread * view.variance.asDiagonal());
  const double opacity = 1 / (1 + std::exp(-splat[kFreeLogit]));
  splat_bar[kFreeLogit] += opacity * (1 - opacity) * bar.opacity;
  for (int k = 0; k < 3; ++k) {
    if (splat[kFreeColour + k] > 0) splat_bar[kFreeColour + k] += bar.colour[k];
  }
}

}  // namespace physpring

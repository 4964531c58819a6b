// SPDX-License-Identifier: Apache-2.0
// Gravity in another direction than declared (a tilted camera frame or table): g is rotated by the
// vector r = tilt_x p + tilt_y q about the two world axes that are most across g; for gravity along
// z these are x and y.
//   g' = c g + s r x g + k r (r . g),   c = cos a, s = sin a / a, k = (1 - c) / a^2, a = |r|
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <utility>

#include "twin/effects/effect.h"

namespace physpring {
namespace {

constexpr double kMostTurned = 3.3;  // rad, more than half a turn

Eigen::Vector3d RotationVector(const Eigen::Vector3d& g, const Eigen::VectorXd& values) {
  Eigen::Index along = 0;
  g.cwiseAbs().maxCoeff(&along);
  Eigen::Vector3d r = Eigen::Vector3d::Zero();
  r[(along + 1) % 3] = values[0];
  r[(along + 2) % 3] = values[1];
  return r;
}

// c, s, k and the derivatives of s and k with respect to a, divided by a.
struct Rodrigues {
  double c, s, k, s_slope, k_slope;

  explicit Rodrigues(double a) : c(std::cos(a)) {
    const bool small = a < 1e-3;
    s = small ? 1 - a * a / 6 : std::sin(a) / a;
    k = small ? 0.5 - a * a / 24 : (1 - c) / (a * a);
    s_slope = small ? -1.0 / 3 + a * a / 30 : (c - s) / (a * a);
    k_slope = small ? -1.0 / 12 + a * a / 180 : (s - 2 * k) / (a * a);
  }
  Eigen::Vector3d Turn(const Eigen::Vector3d& r, const Eigen::Vector3d& g) const {
    return c * g + s * r.cross(g) + k * r.dot(g) * r;
  }
};

class GravityDirection : public Effect {
 public:
  std::string name() const override { return "gravity_direction"; }
  EffectPicture Picture(const Eigen::VectorXd& values, const Setting& before) const override {
    EffectPicture picture;
    picture.lacks =
        fmt::format("a tilt of gravity by about {:.2g}°", values.norm() * 180 / std::numbers::pi);
    Setting after = before;
    Change(values, &after);
    picture.arrows = {{"gravity as declared", "m/s^2", before.gravity, true},
                      {"gravity as found", "m/s^2", after.gravity}};
    return picture;
  }
  std::vector<EffectParameter> parameters() const override {
    return {{"tilt_x_rad", -kMostTurned, kMostTurned, 0.1},
            {"tilt_y_rad", -kMostTurned, kMostTurned, 0.1}};
  }
  // As declared; another axis of the frame points up; or the same one points down.
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem&) const override {
    const double quarter = std::numbers::pi / 2;
    std::vector<Eigen::VectorXd> starts{Eigen::VectorXd::Zero(2)};
    for (const auto& [x, y] : std::initializer_list<std::pair<double, double>>{
             {quarter, 0}, {-quarter, 0}, {0, quarter}, {0, -quarter}, {2 * quarter, 0}}) {
      starts.emplace_back(Eigen::Vector2d(x, y));
    }
    return starts;
  }

  void Change(const Eigen::VectorXd& values, Setting* setting) const override {
    if (values.isZero()) return;
    const Eigen::Vector3d r = RotationVector(setting->gravity, values);
    setting->gravity = Rodrigues(r.norm()).Turn(r, setting->gravity);
  }

  void ChangeAdjoint(const Eigen::VectorXd& values, const Setting& before, SystemGradient* gradient,
                     Eigen::VectorXd* values_bar) const override {
    const Eigen::Vector3d &g = before.gravity, bar = gradient->gravity;
    const Eigen::Vector3d r = RotationVector(g, values);
    const Rodrigues f(r.norm());
    const double along =
        -f.s * bar.dot(g) + f.s_slope * bar.dot(r.cross(g)) + f.k_slope * bar.dot(r) * r.dot(g);
    const Eigen::Vector3d r_bar =
        along * r + f.s * g.cross(bar) + f.k * (r.dot(g) * bar + bar.dot(r) * g);
    Eigen::Index axis = 0;
    g.cwiseAbs().maxCoeff(&axis);
    (*values_bar)[0] += r_bar[(axis + 1) % 3];
    (*values_bar)[1] += r_bar[(axis + 2) % 3];
    gradient->gravity = f.Turn(-r, bar);  // the transposed rotation
  }

  EffectMjcf Mjcf(const Eigen::VectorXd&, const SpringMassSystem&) const override {
    return {EffectMjcf::Carrier::kSetting, {}, {}, ""};
  }
};

}  // namespace

std::unique_ptr<Effect> MakeGravityDirection() { return std::make_unique<GravityDirection>(); }

}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
#include "rollout/looks.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <map>
#include <numbers>
#include <random>

#include "twin/uniform.h"

namespace physpring {
namespace {

constexpr double kColour = 0.3, kLight = 0.3;                        // parts of what they are
constexpr double kLightPlace = 0.3, kCamera = 0.01;                  // m
constexpr double kTurn = 1.5 * std::numbers::pi / 180, kView = 1.5;  // rad, degrees

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}

  double Within(double most) { return most * (2 * Uniform(&random_) - 1); }

  // `count` colours of four numbers, the last of which stays. What had one colour has one again.
  void Colours(float* rgba, int count) {
    for (int i = 0; i < count; ++i, rgba += 4) {
      const std::array<float, 3> before = {rgba[0], rgba[1], rgba[2]};
      const auto known = drawn_.find(before);
      if (known != drawn_.end()) {
        std::copy(known->second.begin(), known->second.end(), rgba);
        continue;
      }
      for (int colour = 0; colour < 3; ++colour) {
        const auto factor = static_cast<float>(1 + Within(kColour));
        rgba[colour] = std::clamp(rgba[colour] * factor, 0.0F, 1.0F);
      }
      drawn_[before] = {rgba[0], rgba[1], rgba[2]};
    }
  }

  void Place(double* position, double most) {
    for (int axis = 0; axis < 3; ++axis) position[axis] += Within(most);
  }

  void Brightness(float* rgb) {
    const auto factor = static_cast<float>(1 + Within(kLight));
    for (int colour = 0; colour < 3; ++colour) rgb[colour] *= factor;
  }

  void Turn(double* quaternion) {
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d about = Eigen::Vector3d::Unit(axis);
      double turn[4], turned[4];
      mju_axisAngle2Quat(turn, about.data(), Within(kTurn));
      mju_mulQuat(turned, quaternion, turn);
      mju_copy4(quaternion, turned);
    }
    mju_normalize4(quaternion);
  }

 private:
  std::mt19937_64 random_;
  std::map<std::array<float, 3>, std::array<float, 3>> drawn_;  // by the colour before
};

}  // namespace

void VaryLooks(std::uint64_t seed, mjModel* model) {
  Draw draw(seed);
  draw.Colours(model->mat_rgba, model->nmat);
  draw.Colours(model->geom_rgba, model->ngeom);
  draw.Colours(model->skin_rgba, model->nskin);
  draw.Brightness(model->vis.headlight.diffuse);
  for (int light = 0; light < model->nlight; ++light) {
    draw.Brightness(model->light_diffuse + 3 * light);
    draw.Place(model->light_pos + 3 * light, kLightPlace);
  }
  for (int camera = 0; camera < model->ncam; ++camera) {
    draw.Place(model->cam_pos + 3 * camera, kCamera);
    draw.Turn(model->cam_quat + 4 * camera);
    model->cam_fovy[camera] += draw.Within(kView);
  }
}

}  // namespace physpring

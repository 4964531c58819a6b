// SPDX-License-Identifier: Apache-2.0
// A scene that undeclared effects are tried on: a body of 0.1 kg on a vertical spring of 10 N/m and
// 0.1 m under a hand, and two more such bodies that hold on to each other and to nothing else. The
// springs are tendons, or the edges of a flex.
#ifndef PHYSPRING_TESTS_ROLLOUT_UNDECLARED_SCENE_H_
#define PHYSPRING_TESTS_ROLLOUT_UNDECLARED_SCENE_H_

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "rollout/record.h"
#include "tests/support/scene_test.h"
#include "twin/error.h"

namespace physpring {

constexpr double kStep = 1e-4, kMass = 0.1, kSpring = 10, kGravity = 9.81;  // s, kg, N/m, m/s^2
constexpr double kFps = 50, kDuration = 0.5;
constexpr int kHanging = 0, kFree = 1, kPair = 2;  // points

enum class Springs { kTendons, kEdges };

struct SceneOptions {
  Springs springs = Springs::kTendons;
  std::string gravity = "0 0 -9.81";
  double below = 0.1;  // m, of the hanging body under the hand
  double later = 0;    // s, of the keys
  std::string free_place = "0.3 0 0.5", geom = "contype='0' conaffinity='0'";
  std::string ground = {};
  double step = kStep;  // s
};

inline std::string SceneOf(const SceneOptions& options) {
  const bool tendons = options.springs == Springs::kTendons;
  const auto body = [&](const char* name, const std::string& place) {
    return fmt::format(
        R"(<body name="{}" pos="{}"><joint type="slide" axis="1 0 0"/>
           <joint type="slide" axis="0 1 0"/><joint type="slide" axis="0 0 1"/>
           <geom size="0.02" mass="{}" friction="0.2" {}/><site name="{}"/></body>)",
        name, place, kMass, options.geom, name);
  };
  const auto spring = [](const char* p, const char* q) {
    return fmt::format(R"(<spatial stiffness="{}" springlength="0.1"><site site="{}"/>
                          <site site="{}"/></spatial>)",
                       kSpring, p, q);
  };
  return fmt::format(
      R"(<mujoco><option timestep="{}" integrator="Euler" gravity="{}"/>
         <worldbody>{}<body name="hand" mocap="true" pos="0 0 0.5"><site name="hand"/></body>{}{}{}
         </worldbody>{}
         <keyframe><key time="0" mpos="0 0 0.5"/><key time="{}" mpos="0 0 0.5"/>
         <key time="{}" mpos="0.02 0 0.6"/></keyframe></mujoco>)",
      options.step, options.gravity, options.ground,
      body("hanging", fmt::format("0 0 {}", 0.5 - options.below)), body("free", options.free_place),
      body("pair", "0.4" + options.free_place.substr(3)),
      tendons ? "<tendon>" + spring("hand", "hanging") + spring("free", "pair") + "</tendon>"
              : fmt::format(R"(<deformable><flex name="lines" dim="1" body="hand hanging free pair"
                   element="0 1 2 3"><edge stiffness="{}"/><contact contype="0" conaffinity="0"/>
                   </flex></deformable>)",
                            kSpring),
      1 + options.later, 2 + options.later);
}

// z(t) of one degree of freedom from rest, at the frames, as MuJoCo's Euler integrates it.
inline std::vector<double> Integrate(
    const std::function<double(double t, double z, double v)>& rate) {
  std::vector<double> z_at;
  double z = 0, v = 0;
  for (int step = 0; step <= std::lround(kDuration / kStep); ++step) {
    if (step % std::lround(1 / (kFps * kStep)) == 0) z_at.push_back(z);
    v += kStep * rate(step * kStep, z, v);
    z += kStep * v;
  }
  return z_at;
}

class UndeclaredScene : public SceneTest {
 protected:
  Recording Record(const SceneOptions& scene, const SceneEffects& effects) const {
    RecordOptions options{.duration = kDuration, .fps = kFps};
    options.effects = effects;
    return RecordScene(WriteScene(SceneOf(scene)), options);
  }

  // A point's way along an axis is that of the integration, up to `tolerance`.
  static void ExpectWay(const Recording& recording, int point, int axis,
                        const std::vector<double>& expected, double tolerance) {
    double moved = 0;
    for (std::size_t frame = 0; frame < expected.size(); ++frame) {
      const double way = recording.points[frame](axis, point) - recording.points[0](axis, point);
      EXPECT_NEAR(way, expected[frame], tolerance) << "frame " << frame;
      moved = std::max(moved, std::abs(way));
    }
    EXPECT_GT(moved, 100 * tolerance);  // else the test would say nothing
  }

  std::string ErrorOf(const SceneOptions& scene, const SceneEffects& effects) const {
    try {
      Record(scene, effects);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
};

// The same equation, step by step: rounding only.
constexpr double kSame = 1e-9;

}  // namespace physpring

#endif  // PHYSPRING_TESTS_ROLLOUT_UNDECLARED_SCENE_H_

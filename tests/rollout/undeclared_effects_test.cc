// SPDX-License-Identifier: Apache-2.0
// What each undeclared effect does to the motion, against closed forms and against integrations of
// one degree of freedom here.
#include "rollout/undeclared_effects.h"

#include <cmath>
#include <numbers>

#include "tests/rollout/undeclared_scene.h"

namespace physpring {
namespace {

class UndeclaredEffectsTest : public UndeclaredScene,
                              public testing::WithParamInterface<Springs> {};

TEST_P(UndeclaredEffectsTest, WithoutAnyTheBodyHangsOnItsSpring) {
  const Recording recording = Record({.springs = GetParam()}, {});
  ExpectWay(recording, kHanging, 2,
            Integrate([](double, double z, double) { return -kSpring * z / kMass - kGravity; }),
            kSame);
  ExpectWay(recording, kFree, 2, Integrate([](double, double, double) { return -kGravity; }),
            kSame);
}

TEST_P(UndeclaredEffectsTest, AddedMassSlowsTheOscillation) {
  const Recording recording =
      Record({.springs = GetParam()}, {{"mass_distribution.mass_kg", 0.05},
                                       {"mass_distribution.place_x_m", 0.02},
                                       {"mass_distribution.place_y_m", 0},
                                       {"mass_distribution.place_z_m", 0.35}});
  const double mass = kMass + 0.05;
  ExpectWay(recording, kHanging, 2,
            Integrate([&](double, double z, double) { return -kSpring * z / mass - kGravity; }),
            kSame);
  EXPECT_NEAR(recording.mass, 3 * kMass, 1e-12);  // as declared
}

TEST_P(UndeclaredEffectsTest, TetherHoldsAFreeBody) {
  SceneEffects tether{{"tether.stiffness_n_per_m", 20}, {"tether.damping_n_s_per_m", 0.5}};
  tether["tether.anchor_z_m"] = 0.6;
  // the free end is a body of the pair; the other one hangs on its spring's sideways pull only
  const Recording recording = Record({.springs = GetParam()}, tether);
  const double way = recording.points[5](2, kPair) - 0.5, t = 5 / kFps;
  // m z'' = K (0.1 - z) - C z' - m g, at first without the neighbour
  const auto alone = Integrate(
      [](double, double z, double v) { return (20 * (0.1 - z) - 0.5 * v) / kMass - kGravity; });
  // the neighbour pulls with at most k (sqrt(0.1^2 + dz^2) - 0.1), dz < 0.1
  EXPECT_NEAR(way, alone[5], kSpring * 0.042 * t * t / 2 / kMass);
  EXPECT_GT(recording.points[5](2, kPair) - recording.points[5](2, kFree), 0.05);
}

TEST_P(UndeclaredEffectsTest, GravityTurns) {
  const double tilt = 0.2;
  const Recording recording =
      Record({.springs = GetParam()}, {{"gravity_direction.tilt_y_rad", tilt}});
  // about y by a: (0, 0, -g) becomes (-g sin a, 0, -g cos a)
  ExpectWay(recording, kFree, 0,
            Integrate([&](double, double, double) { return -kGravity * std::sin(tilt); }), kSame);
  ExpectWay(recording, kFree, 2,
            Integrate([&](double, double, double) { return -kGravity * std::cos(tilt); }), kSame);
  EXPECT_EQ(recording.gravity, Eigen::Vector3d(0, 0, -9.81));  // as declared
}

// A body of three parts that are alike: each has a third of the drag.
TEST_P(UndeclaredEffectsTest, AirDragIsQuadraticAgainstTheWind) {
  const double drag = 0.3, wind = 2;
  const Recording recording = Record({.springs = GetParam()}, {{"air_drag.drag_kg_per_m", drag},
                                                               {"air_drag.wind_z_m_per_s", wind}});
  ExpectWay(recording, kFree, 2, Integrate([&](double, double, double v) {
              return -drag / 3 / kMass * std::abs(v - wind) * (v - wind) - kGravity;
            }),
            1e-6);
}

TEST_P(UndeclaredEffectsTest, UniformForceSwingsInTime) {
  const double force = 0.6, period = 0.35;
  const Recording recording = Record({.springs = GetParam()}, {{"uniform_force.force_y_n", force},
                                                               {"uniform_force.period_s", period}});
  ExpectWay(recording, kFree, 1, Integrate([&](double t, double, double) {
              return force / (3 * kMass) * std::sin(2 * std::numbers::pi * t / period);
            }),
            kSame);
}

TEST_P(UndeclaredEffectsTest, AttractionPointsToItsCentre) {
  const double strength = 0.02;
  SceneEffects magnet{{"moving_attraction.strength_n_m2", strength},
                      {"moving_attraction.radius_m", 0}};
  magnet["moving_attraction.centre_x_m"] = 0.0;
  magnet["moving_attraction.centre_y_m"] = 0.0;
  magnet["moving_attraction.centre_z_m"] = 0.2;
  const Recording recording = Record({.springs = GetParam()}, magnet);
  ExpectWay(recording, kHanging, 2, Integrate([&](double, double z, double) {
              const double away = 0.2 - (0.4 + z);
              const double pull = strength / 3 * away / std::pow(away * away + 9e-4, 1.5);
              return (pull - kSpring * z) / kMass - kGravity;
            }),
            kSame);
}

TEST_P(UndeclaredEffectsTest, StiffnessDrifts) {
  const Recording recording =
      Record({.springs = GetParam()}, {{"stiffness_drift.relative_rate_per_s", -1.2}});
  ExpectWay(recording, kHanging, 2, Integrate([](double t, double z, double) {
              return -kSpring * (1 - 1.2 * t) * z / kMass - kGravity;
            }),
            kSame);
}

TEST_P(UndeclaredEffectsTest, SpringsStiffen) {
  const Recording recording = Record({.springs = GetParam()}, {{"stiffening.cubic_n_per_m3", 900}});
  ExpectWay(recording, kHanging, 2, Integrate([](double, double z, double) {
              return (-kSpring * z - 900 * z * z * z) / kMass - kGravity;
            }),
            kSame);
}

TEST_P(UndeclaredEffectsTest, RestLengthChanges) {
  const Recording recording =
      Record({.springs = GetParam(), .gravity = "0 0 0"},
             {{"rest_length.strain_low_end", 0.3}, {"rest_length.strain_high_end", 0.3}});
  ExpectWay(recording, kHanging, 2,
            Integrate([](double, double z, double) { return -kSpring * (z + 0.03) / kMass; }),
            kSame);
}

TEST_P(UndeclaredEffectsTest, ElementsRubAlongTheSprings) {
  const double friction = 0.3;
  const Recording recording = Record({.springs = GetParam()}, {{"dry_friction.force_n", friction}});
  // falls first, against the friction: to the lowest point 2 (m g - F) / k in half a period
  double lowest = 0;
  for (const Points& points : recording.points) lowest = std::min(lowest, points(2, 0) - 0.4);
  EXPECT_NEAR(lowest, -2 * (kMass * kGravity - friction) / kSpring, 2e-3);
}

TEST_P(UndeclaredEffectsTest, EnoughFrictionHoldsTheBody) {
  const Recording recording = Record({.springs = GetParam()}, {{"dry_friction.force_n", 1.2}});
  // MuJoCo's friction creeps; without it the body falls by 0.2 m
  EXPECT_LT((recording.points.back() - recording.points[0]).col(kHanging).norm(), 0.01);
}

TEST_P(UndeclaredEffectsTest, LatencyIsThatOfHandsThatMoveLater) {
  const double latency = 0.04;
  RecordOptions options{.duration = 1.5, .fps = kFps};
  const Recording plain = RecordScene(WriteScene(SceneOf({.springs = GetParam()})), options);
  const Recording later =
      RecordScene(WriteScene(SceneOf({.springs = GetParam(), .later = latency})), options);
  options.effects = {{"control_latency.latency_s", latency}};
  const Recording delayed = RecordScene(WriteScene(SceneOf({.springs = GetParam()})), options);
  EXPECT_GT((plain.points.back() - later.points.back()).norm(), 1e-3);
  for (std::size_t frame = 0; frame < plain.points.size(); ++frame) {
    // rounding of the keys' times
    EXPECT_LT((delayed.points[frame] - later.points[frame]).norm(), 1e-9);
    EXPECT_LT((delayed.controllers[frame] - plain.controllers[frame]).norm(), 1e-9);
  }
}

// Effects that are not there, or of size 0, change no bit; each one of another size does.
TEST_P(UndeclaredEffectsTest, ChangeNoBitAtZeroAndAllAtMore) {
  SceneOptions scene{.springs = GetParam(), .free_place = "0.3 0 0.02"};
  scene.ground = "<geom type='plane' size='1 1 1'/>";
  scene.geom = "";
  scene.step = 1e-3;
  const bool flex = GetParam() == Springs::kEdges;
  if (flex) scene.geom = "contype='0' conaffinity='0'";  // its ground is another matter
  RecordOptions options{.duration = 1.5, .fps = kFps};
  const std::string path = WriteScene(SceneOf(scene));
  const Recording plain = RecordScene(path, options);
  for (const EffectKey& key : EffectKeys()) {
    if (!key.amount) continue;
    options.effects = {{key.name, 0}};
    const bool impossible =
        flex && (key.name.find("strain") != std::string::npos || key.effect() == "ground_contact" ||
                 key.effect() == "tension_only" || key.name == "stiffening.cubic_stiffness_ratio");
    const Recording zero = RecordScene(path, options);
    for (std::size_t frame = 0; frame < plain.points.size(); ++frame) {
      EXPECT_EQ(zero.points[frame], plain.points[frame]) << key.name;
      EXPECT_EQ(zero.controllers[frame], plain.controllers[frame]) << key.name;
    }
    if (impossible && key.effect() != "rest_length") continue;
    options.effects = {{key.name, std::min(0.3, key.high)}};
    if (key.effect() == "tension_only") options.effects[key.name] = 1;
    if (key.effect() == "mass_distribution") {  // the hanging one: a free one falls as before
      options.effects["mass_distribution.place_x_m"] = 0;
      options.effects["mass_distribution.place_z_m"] = 0.4;
    }
    const Recording more = RecordScene(path, options);
    EXPECT_NE(more.points.back(), plain.points.back()) << key.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Of, UndeclaredEffectsTest,
                         testing::Values(Springs::kTendons, Springs::kEdges), [](const auto& one) {
                           return one.param == Springs::kTendons ? "Tendons" : "Edges";
                         });

}  // namespace
}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
// What each undeclared effect does to the motion, against closed forms and against integrations of
// one degree of freedom here. The scene: a body of 0.1 kg on a vertical spring of 10 N/m and 0.1 m
// under a hand, and two more such bodies that hold on to each other and to nothing else. The
// springs are tendons, or the edges of a flex.
#include "rollout/undeclared_effects.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "rollout/record.h"
#include "tests/support/scene_test.h"
#include "twin/error.h"

namespace physpring {
namespace {

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

std::string SceneOf(const SceneOptions& options) {
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
std::vector<double> Integrate(const std::function<double(double t, double z, double v)>& rate) {
  std::vector<double> z_at;
  double z = 0, v = 0;
  for (int step = 0; step <= std::lround(kDuration / kStep); ++step) {
    if (step % std::lround(1 / (kFps * kStep)) == 0) z_at.push_back(z);
    v += kStep * rate(step * kStep, z, v);
    z += kStep * v;
  }
  return z_at;
}

class UndeclaredEffectsTest : public SceneTest, public testing::WithParamInterface<Springs> {
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

class TendonScene : public UndeclaredEffectsTest {};

TEST_F(TendonScene, RatioAndSlipStrainAreOfTheSpring) {
  // k r / L^2 = 900, k L s = 0.3
  const Recording ratio = Record({}, {{"stiffening.cubic_stiffness_ratio", 0.9}});
  const Recording cubic = Record({}, {{"stiffening.cubic_n_per_m3", 900}});
  const Recording slip = Record({}, {{"dry_friction.slip_strain", 0.3}});
  const Recording force = Record({}, {{"dry_friction.force_n", 0.3}});
  EXPECT_LT((ratio.points.back() - cubic.points.back()).norm(), 1e-9);
  EXPECT_LT((slip.points.back() - force.points.back()).norm(), 1e-9);
}

TEST_F(TendonScene, SlackSpringDoesNotPush) {
  // 0.2 m above where the spring begins to pull, on the other side of the hand: nothing holds it
  const Recording recording = Record({.below = -0.09}, {{"tension_only.slack_share", 1}});
  const auto fall = Integrate([](double, double, double) { return -kGravity; });
  for (std::size_t frame = 0; frame < 8; ++frame) {  // 0.13 m
    EXPECT_NEAR(recording.points[frame](2, kHanging) - 0.59, fall[frame], kSame);
  }
  const Recording pushed = Record({.below = -0.09}, {});
  EXPECT_GT(std::abs(pushed.points[7](2, kHanging) - 0.59 - fall[7]), 1e-3);
}

TEST_F(TendonScene, YieldedSpringPullsWithItsLimit) {
  // at the strain 0.5: k 0.05 m = 0.5 N, then constant
  const Recording recording = Record({}, {{"yield.yield_strain", 0.5}});
  double plastic = 0;
  ExpectWay(recording, kHanging, 2, Integrate([&](double, double z, double) {
              plastic = std::clamp(plastic, -z - 0.05, -z + 0.05);
              return -kSpring * (z + plastic) / kMass - kGravity;
            }),
            1e-4);  // MuJoCo updates the rest length at another moment of the step
}

TEST_F(TendonScene, FrictionWithTheGroundChanges) {
  SceneOptions scene{.gravity = "5 0 -9.81", .free_place = "0.3 0 0.02"};
  scene.ground = "<geom type='plane' size='1 1 1' friction='0.3'/>";
  scene.geom = "condim='3'";
  const Recording recording = Record(scene, {{"ground_contact.friction_change", -0.2}});
  const double t = kDuration;  // slides with g_x - mu g_z; soft contacts: 2 %
  const double way = (5 - (0.3 - 0.2) * kGravity) * t * t / 2;
  EXPECT_NEAR(recording.points.back()(0, kFree) - 0.3, way, 0.02 * way);
}

TEST_F(TendonScene, RecordsSitesOfTendons) {
  const Recording recording = Record({}, {});
  EXPECT_EQ(recording.point_count(), 3);
  EXPECT_EQ(recording.controller_count(), 1);
  EXPECT_NEAR(recording.mass, 3 * kMass, 1e-12);
}

constexpr char kSheet[] = R"(
  <mujoco><option timestep="0.001" gravity="0 0 {}" integrator="discrete" solver="CG"
    iterations="500"/><worldbody><body name="hand" mocap="true" pos="0 0 0.5"/>
    <flexcomp name="sheet" type="grid" dim="2" count="5 5 1" spacing="0.02 0.02 0.02" mass="0.05"
      pos="0 0 0.5" radius="0.002"><elasticity young="3e4" poisson="0.2" thickness="0.002"
      damping="0.1" elastic2d="both"/><contact selfcollide="none"/></flexcomp></worldbody>
    <equality><connect body1="sheet_12" body2="hand" anchor="0 0 0"/></equality>
    <keyframe><key time="0" mpos="0 0 0.5"/><key time="2" mpos="0 0 0.5"/></keyframe></mujoco>)";

// Finite elements of other rest lengths are larger by as much.
TEST_F(TendonScene, SheetGrowsToItsRestLength) {
  RecordOptions options;
  options.effects = {{"rest_length.strain_low_end", 0.1}, {"rest_length.strain_high_end", 0.1}};
  const Recording recording = RecordScene(WriteScene(fmt::format(kSheet, 0)), options);
  const Points& last = recording.points.back();
  const double before = (recording.points[0].col(0) - recording.points[0].col(23)).norm();
  EXPECT_NEAR((last.col(0) - last.col(23)).norm() / before, 1.1, 0.005);  // still swings a little
}

TEST_F(TendonScene, SheetThatYieldsSagsMore) {
  RecordOptions options;
  const std::string scene = WriteScene(fmt::format(kSheet, -9.81));
  const Recording elastic = RecordScene(scene, options);
  options.effects = {{"yield.yield_strain", 0.002}};
  const Recording yielding = RecordScene(scene, options);
  EXPECT_LT(yielding.points.back().row(2).minCoeff(),
            elastic.points.back().row(2).minCoeff() - 1e-3);
}

TEST_F(TendonScene, RefusesWhatTheSceneCannotHave) {
  const SceneOptions flex{.springs = Springs::kEdges};
  for (const char* name : {"tension_only.slack_share", "yield.yield_strain",
                           "dry_friction.slip_strain", "ground_contact.friction_change"}) {
    const std::string message = ErrorOf(flex, {{name, 1}});
    EXPECT_NE(message.find(fmt::format("scene.xml: cannot have the effect {}: ", name)),
              std::string::npos)
        << message;
    EXPECT_NE(message.find("it can have air_drag.drag_kg_per_m, "), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
  EXPECT_NE(ErrorOf({}, {{"tension_only.slack_share", 0.5}}).find("wholly"), std::string::npos);
}

TEST_F(TendonScene, RefusesAnEffectWithoutAmount) {
  EXPECT_NE(ErrorOf({}, {{"air_drag.wind_x_m_per_s", 1}})
                .find("air_drag.wind_x_m_per_s needs air_drag.drag_kg_per_m, too"),
            std::string::npos);
}

TEST(ParseEffectTest, ReadsNameAndValue) {
  const auto [name, value] = ParseEffect("tether.anchor_x_m=-0.5");
  EXPECT_EQ(name, "tether.anchor_x_m");
  EXPECT_EQ(value, -0.5);
}

TEST(ParseEffectTest, RefusesOtherNamesAndValues) {
  const auto expect = [](const std::string& text, const std::string& part) {
    try {
      ParseEffect(text);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  expect("wind=3", "there is no effect 'wind', but air_drag.wind_x_m_per_s, ");
  expect("yield.strain=1", "there is no effect 'yield.strain', but yield.yield_strain");
  expect("magnet=1", "there is no effect 'magnet', but air_drag, control_latency, ");
  expect("", "there is no effect '', but air_drag, ");
  for (const char* value : {"", "=", "=x", "=1x", "=nan", "=inf", "=-1", "=1e9"}) {
    expect(std::string("mass_distribution.mass_kg") + value,
           "mass_distribution.mass_kg takes a number from 0 to 100, not '");
  }
}

}  // namespace
}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
// What the plugin library refuses, and the one line that it says then.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/level_scene.h"
#include "tests/support/random_system.h"
#include "tests/support/simulation.h"
#include "twin/error.h"

namespace physpring {
namespace {

using testing::HasSubstr;

// The error with which `mjcf` does not compile.
std::string Refusal(const std::string& mjcf) {
  try {
    CompileMjcf(mjcf);
  } catch (const Error& error) {
    return error.what();
  }
  return "it compiles";
}

SpringMassSystem Pair() {
  Points position(3, 3);
  position << 0, 0.1, 0.2, 0, 0, 0, 0, 0, 0;
  SpringMassSystem pair = Particles(position, 0.1, 1);
  AddSpring(0, 1, 100, 0.1, 0.1, &pair);
  AddSpring(1, 2, 100, 0.1, 0.1, &pair);
  return pair;
}

std::string WithAttribute(const std::string& key, const std::string& value) {
  return LevelMjcf(Pair(), {.contact = true, .config = {{key, value}}});
}

struct Case {
  const char *key, *value, *message;
};

TEST(Messages, NameAttributeAndValue) {
  const Case cases[] = {
      {"springs", "0 1 1", "physpring.springs 'rope': attribute 'springs' has 3 numbers"},
      {"springs", "0 1 1 x", "attribute 'springs' has 'x' as value 3, expected a whole number"},
      {"springs", "0 1 1 7", "springs[1] joins 1 and 7, expected numbers from 0 to 2"},
      {"springs", " ", "attribute 'springs' is missing"},
      {"stiffness", "100", ""},
      {"stiffness", "1 2 3", "attribute 'stiffness' has 3 values, expected 1 or 2"},
      {"stiffness", "1 nan",
       "attribute 'stiffness' has 'nan' as value 1, expected a finite number"},
      {"stiffness", "1 -2", "stiffness[1] is -2, expected 0 or more"},
      {"rest_length", "0.1 0", "rest_length[1] is 0, expected more than 0"},
      {"dashpot", "-1", "dashpot[0] is -1, expected 0 or more"},
      {"drag", "-1", "drag is -1, expected 0 or more"},
      {"drag", "1 2", "attribute 'drag' has 2 values, expected one"},
      {"substep", "0", "attribute 'substep' is 0 s, expected more than 0"},
      {"substep", "1", "attribute 'substep' is 1 s, expected more than 0 and at most 0.0"},
      {"controller_velocity", "2", "attribute 'controller_velocity' is 2, expected 0 or 1"},
      {"released", "2", "released[0] is 2, expected 0 or 1"},
      {"nodes", "3", "attribute 'nodes' is 3, but the model has 2"},
      {"controllers", "0", "attribute 'controllers' is 0, but the model has 1"},
      {"restitution", "1.5", "restitution is 1.5, expected 0 to 1"},
      {"friction", "-1", "friction is -1, expected 0 to 2"},
      {"object_restitution", "2", "object_restitution is 2, expected 0 to 1"},
      {"object_friction", "3", "object_friction is 3, expected 0 to 2"},
      {"cone", "round", "attribute 'cone' is 'round', expected elliptic or pyramidal"},
      // as MuJoCo, which takes no blanks around its keywords
      {"cone", " pyramidal", "attribute 'cone' is ' pyramidal', expected elliptic or pyramidal"},
      {"cone", "elliptic", ""},
      {"effects", "[]", ""},
      {"substep", "1e-300",
       "attribute 'substep' is 1e-300 s, less than a millionth of the time step"},
      {"collision_distance", "-1", "collision_distance is -1, expected 0 or more"},
      {"contact_radius", "1 2 3", "attribute 'contact_radius' has 3 values, expected 1 or 2"},
  };
  for (const Case& c : cases) {
    const std::string mjcf = WithAttribute(c.key, c.value);
    if (*c.message == '\0') {
      EXPECT_NO_THROW(CompileMjcf(mjcf)) << c.key;
    } else {
      EXPECT_THAT(Refusal(mjcf), HasSubstr(c.message));
    }
  }
}

// Such text, parsed without a bound, overflows the stack of the process that MuJoCo runs in.
TEST(Messages, DeepEffectsAreRefused) {
  EXPECT_THAT(Refusal(WithAttribute("effects", std::string(100000, '['))),
              HasSubstr("attribute 'effects': is nested more than 32 deep"));
  const std::string deep = std::string(100000, '[') + std::string(100000, ']');
  EXPECT_THAT(Refusal(WithAttribute("effects", deep)),
              HasSubstr("attribute 'effects': is nested more than 32 deep"));
}

TEST(Messages, UnknownAttributeIsRefusedByMujoco) {
  EXPECT_THROW(CompileMjcf(WithAttribute("stifness", "1")), Error);
}

TEST(Messages, NameIntegrator) {
  for (const char* integrator : {"RK4", "discrete"}) {
    const std::string option = "integrator=\"" + std::string(integrator) + "\"";
    EXPECT_THAT(Refusal(LevelMjcf(Pair(), {.option = option})),
                HasSubstr("option integrator is " + std::string(integrator) + ", expected Euler"));
  }
}

// A level's MJCF with its first `from` replaced.
std::string Damaged(const std::string& from, const std::string& to,
                    const LevelSceneOptions& options = {}) {
  std::string mjcf = LevelMjcf(Pair(), options);
  const std::size_t at = mjcf.find(from);
  EXPECT_NE(at, std::string::npos);
  return mjcf.replace(at, from.size(), to);
}

TEST(Messages, NameBody) {
  // the only body that refers to the instance is the controller
  EXPECT_THAT(Refusal(Damaged(R"(<plugin instance="rope"/>)", "")),
              HasSubstr("no body that is fixed in the world refers to it"));
  EXPECT_THAT(Refusal(Damaged(R"(<joint type="slide")", R"(<joint type="hinge")")),
              HasSubstr("body 'rope_0' is a node, expected three orthogonal slide joints"));
  EXPECT_THAT(Refusal(Damaged(R"(axis="1 0 0")", R"(axis="1 1 0")")),
              HasSubstr("body 'rope_0' is a node, expected three orthogonal slide joints"));
  EXPECT_THAT(Refusal(Damaged(R"(axis="1 0 0")", R"(axis="1 0 0" armature="0.1")")),
              HasSubstr("body 'rope_0' has joint armature 0.1, expected 0"));
  EXPECT_THAT(Refusal(Damaged(R"(mocap="true")", "")),
              HasSubstr("body 'rope' and body 'rope_2' are both fixed in the world"));
}

// The compiler decides about sleep after it has tried the plugins.
TEST(Messages, NameNodeThatMayFallAsleep) {
  const ModelPtr model =
      CompileMjcf(Damaged(R"(sleep="never")", "", {.flags = R"(sleep="enable")"}));
  EXPECT_THROW(MakeData(*model), Error);
}

TEST(Messages, SleepIsFineWhereNodesStayAwake) {
  const ModelPtr model = CompileMjcf(LevelMjcf(Pair(), {.flags = R"(sleep="enable")"}));
  EXPECT_NO_THROW(MakeData(*model));
}

// Velocities beyond all bounds: MuJoCo warns once and resets.
TEST(Messages, UnstableStepIsReportedByMujoco) {
  LevelScene scene(RandomSystem(40, 2, 3), {.timestep = 2e-3, .substep = 0.5e-3});
  scene.SetState(RandomSystem(40, 2, 3).position.leftCols(40), Points::Constant(3, 40, 1e300));
  EXPECT_THROW(scene.Step(5), Error);
}

}  // namespace
}  // namespace physpring

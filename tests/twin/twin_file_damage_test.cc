// SPDX-License-Identifier: Apache-2.0
// A twin's file that is damaged or disagrees with itself is refused with one line.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <random>
#include <tuple>

#include "tests/support/sound_twin.h"
#include "twin/error.h"

namespace physpring {
namespace {

TEST_F(TwinFile, EveryDamageIsRefused) {
  ExpectEveryDamageIsRefused(path_, [this] { ReadTwin(path_); });
}

TEST_F(TwinFile, EveryArrayIsNeeded) {
  const Npz sound = arrays_;
  for (const auto& [name, array] : sound) {
    if (name == "order" || name == "train/adam_m") continue;
    arrays_ = sound;
    arrays_.erase(name);
    EXPECT_NE(ErrorOfChanged().find("array '" + name + "' is missing"), std::string::npos) << name;
  }
}

TEST_F(TwinFile, EveryArrayHasOneShape) {
  const Npz sound = arrays_;
  for (const auto& [name, array] : sound) {
    if (name == "meta" || name == "train/adam_m") continue;
    arrays_ = sound;
    arrays_[name].shape.push_back(1);
    const std::string error = ErrorOfChanged();
    EXPECT_NE(error.find("array '" + name + "' has the shape"), std::string::npos) << error;
  }
}

// The array that is too short is the one that is named, once.
TEST_F(TwinFile, ListsAreAsLongAsThereAreNodesAndSprings) {
  const std::vector<std::pair<const char*, const char*>> lists{
      {"mass", "nodes"},          {"contact_radius", "nodes"}, {"stiffness", "springs"},
      {"rest_length", "springs"}, {"dashpot", "springs"},
  };
  const Npz sound = arrays_;
  for (const auto& [name, counted] : lists) {
    arrays_ = sound;
    arrays_[std::string("level0/") + name] = Vector({1, 1});
    EXPECT_EQ(
        ErrorOfChanged(),
        fmt::format("{0}: array 'level0/{1}' has the shape (2,), expected ({2},) with {2} = 3",
                    path_, name, counted));
  }
}

TEST_F(TwinFile, NamesFileAndArrayOnceWhereTheTypeIsWrong) {
  const std::uint8_t yes = 1;
  const NpzArray flag{"|b1", {}, {yes}};
  const std::vector<std::tuple<const char*, NpzArray, const char*>> cases{
      {"level0/cone", Scalar(1),
       "has the type '<f8' and the shape (), expected text: '|u1' and (n,)"},
      {"level0/effects", Scalar(1),
       "has the type '<f8' and the shape (), expected text: '|u1' and (n,)"},
      {"level0/springs", Vector({0, 1}), "has the shape (2,), expected (springs, 2)"},
      {"level0/substeps_per_second", Vector({9}), "has the shape (1,), expected ()"},
      {"level0/substeps_per_second", Scalar(0.5), "holds 0.5, expected whole numbers"},
      {"level0/substeps_per_second", flag, "has the type '|b1', expected whole numbers"},
      {"level1/assignment", Scalar(0),
       "has the shape (), expected (nodes below,) with nodes below = 3"},
  };
  const Npz sound = arrays_;
  for (const auto& [name, array, message] : cases) {
    arrays_ = sound;
    arrays_[name] = array;
    EXPECT_EQ(ErrorOfChanged(), fmt::format("{}: array '{}' {}", path_, name, message));
  }
  arrays_ = sound;
  arrays_.erase("meta");
  EXPECT_EQ(ErrorOfChanged(), path_ + ": array 'meta' is missing");
}

TEST_F(TwinFile, EveryArrayHoldsFiniteNumbers) {
  const Npz sound = arrays_;
  for (const auto& [name, array] : sound) {
    if (name == "meta" || name == "train/adam_m") continue;
    std::vector<double> values = array.ToDoubles();
    values.back() = kNan;
    arrays_ = sound;
    arrays_[name] = NpzArray::Doubles(array.shape, values.data());
    const std::string error = ErrorOfChanged();
    EXPECT_NE(error.find("array '" + name + "' holds nan"), std::string::npos) << error;
  }
}

TEST_F(TwinFile, RefusesWhatDisagrees) {
  struct Case {
    const char* name;
    NpzArray array;
    const char* message;
  };
  const std::vector<Case> cases{
      {"level2/mass", Vector({1}), "array 'level2/mass' is not part of a twin of 2 levels"},
      {"colour", Scalar(1), "array 'colour' is not part of a twin"},
      {"level0/assignment", Ints({0, 0, 0}), "'level0/assignment' is not part"},
      {"level1/assignment", Ints({0, 2, 1}), "holds 2 at [1], expected nodes from 0 to 1"},
      {"level1/assignment", Ints({0, -1, 1}), "holds -1 at [1]"},
      {"level1/assignment", Ints({1, 1, 1}), "gives nothing to node 0"},
      {"level1/assignment", Ints({0, 1}),
       "shape (2,), expected (nodes below,) with nodes below = 3"},
      {"level0/mass", Vector({1, 0, 1}), "level 0: mass[1] is 0, expected more than 0"},
      {"level1/stiffness", Vector({1, -1}), "level 1: stiffness[1] is -1, expected 0 or more"},
      {"level1/rest_length", Vector({0, 1}), "level 1: rest_length[0] is 0, expected more than 0"},
      {"level1/dashpot", Vector({-1, 1}), "level 1: dashpot[0] is -1"},
      {"level1/drag", Scalar(-1), "level 1: drag is -1, expected 0 or more"},
      {"level1/restitution", Scalar(1.5), "restitution is 1.5, expected 0 to 1"},
      {"level1/friction", Scalar(2.5), "friction is 2.5, expected 0 to 2"},
      {"level1/object_restitution", Scalar(-1), "object_restitution is -1, expected 0 to 1"},
      {"level1/object_friction", Scalar(3), "object_friction is 3, expected 0 to 2"},
      {"level1/collision_distance", Scalar(-1), "collision_distance is -1, expected 0 or more"},
      {"level1/contact_radius", Vector({0, -1}), "contact_radius[1] is -1"},
      {"level1/substeps_per_second", Scalar(0), "holds 0, expected more than 0"},
      {"level1/dashpot_stages", Scalar(0), "level 1: dashpot_stages is 0, expected 1 to 8"},
      {"level1/dashpot_stages", Scalar(9), "dashpot_stages is 9, expected 1 to 8"},
      {"level1/substeps_per_second", Scalar(0.5), "holds 0.5, expected whole numbers"},
      {"fps", Scalar(0), "array 'fps' holds 0, expected more than 0"},
      {"order", Vector({1, 2}), "array 'order' has the shape (2,)"},
      {"meta", NpzArray::Text("{"), "array 'meta': is not JSON"},
      {"meta", NpzArray::Text("[1]"), "array 'meta': is not a JSON object"},
      {"meta", NpzArray::Text(std::string(100000, '[')), "is nested more than 32 deep"},
      {"meta", Scalar(1), "array 'meta' has the type '<f8'"},
      {"level0/effects", NpzArray::Text(std::string(100000, '[') + std::string(100000, ']')),
       "level 0: array 'effects': is nested more than 32 deep"},
  };
  const Npz sound = arrays_;
  for (const Case& c : cases) {
    arrays_ = sound;
    arrays_[c.name] = c.array;
    const std::string error = ErrorOfChanged();
    EXPECT_NE(error.find(c.message), std::string::npos) << c.name << " gave " << error;
  }
}

TEST_F(TwinFile, RefusesImpossibleSprings) {
  const std::vector<std::pair<std::vector<int>, const char*>> cases{
      {{0, 1, 1, 2, 2, 4}, "springs[2] joins 2 and 4, expected numbers from 0 to 3"},
      {{0, 1, 1, 2, 2, -1}, "springs[2] joins -1 and 2"},
      {{0, 1, 1, 2, 2, 2}, "springs[2] joins 2 and 2, expected two different nodes"},
      {{0, 1, 1, 2, 1, 0}, "springs joins 0 and 1 twice"},
      {{0, 1, 1, 2}, "'level0/stiffness' has the shape (3,), expected (springs,) with springs = 2"},
  };
  for (const auto& [ends, message] : cases) {
    arrays_["level0/springs"] = NpzArray::Ints({ends.size() / 2, 2}, ends.data());
    const std::string error = ErrorOfChanged();
    EXPECT_NE(error.find(message), std::string::npos) << error;
  }
}

TEST_F(TwinFile, RefusesAnotherFormatOrVersion) {
  const Npz sound = arrays_;
  const std::vector<std::array<const char*, 3>> cases{
      {"\"version\": 1", "\"version\": 2", "key 'version' holds 2, expected 1"},
      {"\"version\": 1", "\"version\": \"1\"", "expected a whole number"},
      {"physpring twin", "other", "key 'format' is not 'physpring twin'"},
      {"\"seed\"", "\"sead\"", "key 'sead' is not known"},
      {"\"levels\": 2", "\"levels\": 0", "key 'levels' holds 0"},
      {"\"levels\": 2", "\"levels\": 3", "array 'level2/position' is missing"},
      {"\"levels\": 2", "\"levels\": -2", "key 'levels' holds '-2', expected a whole number"},
      {"\"points\": 2", "\"points\": 3", "counts 3 points and 1 interior particles"},
      {"\"points\": 2", "\"points\": 99999999999", "expected a number below 2^31"},
      {"\"controllers\": 1", "\"controllers\": 2",
       "'level0/mass' has the shape (3,), expected (nodes,) with nodes = 2"},
      {"\"controllers\": 1", "\"controllers\": 4",
       "'level0/position' holds 4 places, 4 of them controllers, expected a node or more"},
      {"\"controller_velocity\": false", "\"controller_velocity\": 0", "expected true or false"},
      {"0123456789abcdef", "0123", "'recordings[0].hash' is not 16 hexadecimal digits"},
      {"\"train_frames\"", "\"frames\"", "key 'recordings[0].frames' is not known"},
  };
  for (const auto& [old_text, new_text, message] : cases) {
    arrays_ = sound;
    ReplaceInMeta(old_text, new_text);
    const std::string error = ErrorOfChanged();
    EXPECT_NE(error.find(message), std::string::npos) << error;
  }
}

TEST_F(TwinFile, DoesNotWriteWhatItWouldNotRead) {
  const std::string before = ReadFile(path_);
  const auto expect_refused = [&](const Twin& twin, const std::string& message) {
    const std::string error = ErrorOf(path_, [&] { WriteTwin(twin, path_); });
    EXPECT_NE(error.find(message), std::string::npos) << error;
    EXPECT_EQ(ReadFile(path_), before);
  };
  Twin twin = MakeTwin();
  twin.levels[0].system.stiffness[1] = kNan;
  expect_refused(twin, "array 'level0/stiffness' holds nan at [1]");
  twin = MakeTwin();
  twin.levels.clear();
  expect_refused(twin, "key 'levels' holds 0");
  twin = MakeTwin();
  twin.options_json = "--epochs 3";
  expect_refused(twin, "options: is not JSON");
  twin = MakeTwin();
  twin.training_state["level0/mass"] = Vector({1});
  expect_refused(twin, "training state 'level0/mass' is not named train/NAME");
  twin = MakeTwin();
  twin.levels[0].system.springs.clear();
  for (auto* values : {&twin.levels[0].system.stiffness, &twin.levels[0].system.rest_length,
                       &twin.levels[0].system.dashpot}) {
    values->resize(0);
  }
  expect_refused(twin, "array 'level0/springs' holds no spring");
}

// Arrays are changed at random and packed again with right checksums, so that every check behind
// the archive is met: whatever is accepted is a valid twin, whatever is not is one line.
TEST_F(TwinFile, SurvivesRandomChanges) {
  std::mt19937 random(3);
  const Npz sound = arrays_;
  int accepted = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    arrays_ = sound;
    MutateArrays(arrays_, random);
    Overwrite(path_, PackNpz(arrays_, path_));
    try {
      const Twin twin = ReadTwin(path_);
      for (const TwinLevel& level : twin.levels) level.system.Validate("accepted");
      ++accepted;
    } catch (const Error& error) {
      ExpectOneLine(path_, error.what());
    }
  }
  EXPECT_GT(accepted, 0);  // the changes are not all hopeless
}

}  // namespace
}  // namespace physpring

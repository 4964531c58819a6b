// SPDX-License-Identifier: Apache-2.0
// A sound twin with all that there can be in its file, and that file, whose arrays a test changes.
#ifndef PHYSPRING_TESTS_SUPPORT_SOUND_TWIN_H_
#define PHYSPRING_TESTS_SUPPORT_SOUND_TWIN_H_

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "tests/support/file_damage.h"
#include "tests/support/temporary_folder.h"
#include "twin/atomic_file.h"
#include "twin/npz.h"
#include "twin/twin.h"

namespace physpring {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kThird = 1.0 / 3.0;  // needs every bit of a double

inline NpzArray Scalar(double value) { return NpzArray::Doubles({}, &value); }
inline NpzArray Vector(const std::vector<double>& values) {
  return NpzArray::Doubles({values.size()}, values.data());
}
inline NpzArray Ints(const std::vector<int>& values) {
  return NpzArray::Ints({values.size()}, values.data());
}

// A chain of `nodes` nodes with one controller at its end.
inline TwinLevel MakeLevel(int nodes) {
  TwinLevel level;
  SpringMassSystem& system = level.system;
  system.position = Points::Zero(3, nodes + 1);
  for (int i = 0; i <= nodes; ++i) system.position(0, i) = kThird * i;
  system.controllers = 1;
  system.mass = Eigen::VectorXd::Constant(nodes, 0.1 * kThird);
  for (int i = 0; i < nodes; ++i) system.springs.push_back({i, i + 1});
  system.stiffness = Eigen::VectorXd::LinSpaced(nodes, kThird, 1e5);
  system.rest_length = Eigen::VectorXd::Constant(nodes, kThird);
  system.dashpot = Eigen::VectorXd::Constant(nodes, std::numeric_limits<double>::denorm_min());
  system.drag = 0.1;
  system.contact_radius = Eigen::VectorXd::Constant(nodes, 1e-3);
  level.substeps_per_second = 20010;
  return level;
}

inline Twin MakeTwin() {
  Twin twin;
  twin.name = "rope \"of 1 m\"";
  twin.levels = {MakeLevel(3), MakeLevel(2)};
  twin.levels[1].assignment = {0, 0, 1};
  twin.points = 2;
  twin.interior = 1;
  twin.rod = PlainRod(Eigen::VectorXd::LinSpaced(4, 0, 1));
  twin.fps = 29.97;
  twin.controller_velocity = false;
  twin.trained_on = {{"rope_lift", "0123456789abcdef", 84}};
  twin.options_json = R"({"epochs":200,"precision":"double","radius":0.1})";
  twin.seed = std::numeric_limits<std::uint64_t>::max();
  twin.training_state["train/adam_m"] = Vector({kThird, -0.0, kNan});
  return twin;
}

// A sound twin file whose arrays a test changes.
class TwinFile : public testing::Test {
 protected:
  TwinFile() : path_(folder_.File("rope.twin.npz")) {
    WriteTwin(MakeTwin(), path_);
    arrays_ = ReadNpz(path_);
  }

  std::string ErrorOfChanged() {
    Overwrite(path_, PackNpz(arrays_, path_));
    return ErrorOf(path_, [this] { ReadTwin(path_); });
  }

  // Replaces text in `meta`; it must be there.
  void ReplaceInMeta(const std::string& old_text, const std::string& new_text) {
    std::string meta = arrays_["meta"].ToText();
    const std::size_t place = meta.find(old_text);
    ASSERT_NE(place, std::string::npos) << old_text << " in " << meta;
    arrays_["meta"] = NpzArray::Text(meta.replace(place, old_text.size(), new_text));
  }

  TemporaryFolder folder_;
  std::string path_;
  Npz arrays_;
};

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_SOUND_TWIN_H_

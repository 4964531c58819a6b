// SPDX-License-Identifier: Apache-2.0
// A twin is read as it was written, bit for bit.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <tuple>

#include "tests/support/sound_twin.h"
#include "twin/error.h"

namespace physpring {
namespace {

TEST_F(TwinFile, ReadsBackWhatWasWritten) {
  const Twin twin = MakeTwin();
  const Twin read = ReadTwin(path_);
  EXPECT_EQ(read.name, twin.name);
  EXPECT_EQ(read.points, 2);
  EXPECT_EQ(read.interior, 1);
  EXPECT_EQ(read.rod, twin.rod);
  EXPECT_EQ(read.fps, 29.97);
  EXPECT_EQ(read.gravity, twin.gravity);
  EXPECT_FALSE(read.controller_velocity);
  EXPECT_EQ(read.seed, twin.seed);
  EXPECT_EQ(read.options_json, twin.options_json);
  ASSERT_EQ(read.trained_on.size(), 1u);
  EXPECT_EQ(read.trained_on[0].name, "rope_lift");
  EXPECT_EQ(read.trained_on[0].hash, "0123456789abcdef");
  EXPECT_EQ(read.trained_on[0].train_frames, 84);
  EXPECT_TRUE(read.training_state == twin.training_state);
  ASSERT_EQ(read.levels.size(), 2u);
  EXPECT_TRUE(read.levels[0].assignment.empty());
  EXPECT_EQ(read.levels[1].assignment, twin.levels[1].assignment);
}

TEST_F(TwinFile, ReadsBackEveryLevelExactly) {
  const Twin twin = MakeTwin();
  const Twin read = ReadTwin(path_);
  for (std::size_t n = 0; n < 2; ++n) {
    const SpringMassSystem& expected = twin.levels[n].system;
    const SpringMassSystem& system = read.levels[n].system;
    EXPECT_EQ(system.position, expected.position);
    EXPECT_EQ(system.controllers, 1);
    EXPECT_EQ(system.mass, expected.mass);
    EXPECT_EQ(system.springs, expected.springs);
    EXPECT_EQ(system.stiffness, expected.stiffness);
    EXPECT_EQ(system.rest_length, expected.rest_length);
    EXPECT_EQ(system.dashpot, expected.dashpot);
    EXPECT_EQ(system.drag, expected.drag);
    EXPECT_EQ(system.contact.surface.restitution, expected.contact.surface.restitution);
    EXPECT_EQ(system.contact.surface.friction, expected.contact.surface.friction);
    EXPECT_EQ(system.contact.object.restitution, expected.contact.object.restitution);
    EXPECT_EQ(system.contact.object.friction, expected.contact.object.friction);
    EXPECT_EQ(system.contact.collision_distance, expected.contact.collision_distance);
    EXPECT_EQ(system.contact_radius, expected.contact_radius);
    EXPECT_EQ(read.levels[n].substeps_per_second, 20010);
  }
}

TEST_F(TwinFile, KeepsTheStagesOfDashpots) {
  Twin twin = MakeTwin();
  twin.levels[1].system.dashpot_stages = 5;
  WriteTwin(twin, path_);
  const Twin read = ReadTwin(path_);
  EXPECT_EQ(read.levels[0].system.dashpot_stages, 1);
  EXPECT_EQ(read.levels[1].system.dashpot_stages, 5);
}

TEST_F(TwinFile, KeepsARodWithBranchesOnAllLevels) {
  Twin twin = MakeTwin();
  twin.rod = RodOfEdges({{0, 1}, {0, 2}, {0, 3}}, twin.levels[0].system.position);
  WriteTwin(twin, path_);
  const Twin read = ReadTwin(path_);
  EXPECT_EQ(read.rod, twin.rod);
  EXPECT_EQ(read.levels[0].system.rod, twin.rod);
  const SpringMassSystem& coarse = read.levels[1].system;
  EXPECT_EQ(coarse.rod, CoarseRod(twin.rod, read.levels[1].assignment, coarse.node_count()));
  twin.rod.edges.push_back({3, 4});
  try {
    WriteTwin(twin, path_);  // reads it again
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("array 'rod' has an edge from 3 to 4"),
              std::string::npos)
        << error.what();
  }
}

TEST_F(TwinFile, KeepsTheMaterial) {
  Twin twin = MakeTwin();
  EXPECT_FALSE(ReadTwin(path_).material) << "files of older programs have none";
  twin.material = Material{{{0.01, 0.02, 7, {0.1, 0.05, 1.0 / 3}}},
                           {1e-3, 0, 2e-3},
                           {2, 1, 4},
                           {{1, 2, 3}, {0.5, 0.4, 0.6}},
                           {{3, 2, 1}, {1.5, 1.4, 1.6}}};
  WriteTwin(twin, path_);
  const Twin read = ReadTwin(path_);
  ASSERT_TRUE(read.material);
  EXPECT_EQ(MaterialToJson(*read.material), MaterialToJson(*twin.material));
  EXPECT_EQ(read.material->classes[0].axial_stiffness.high, 1.0 / 3);
  twin.material->drag.low = 3;
  EXPECT_THROW(WriteTwin(twin, path_), Error) << "the value is below its lower bound";
}

TEST_F(TwinFile, KeepsTheErrorsOfItsFit) {
  Twin twin = MakeTwin();
  EXPECT_FALSE(ReadTwin(path_).fit_errors) << "files of older programs have none";
  for (const std::optional<double> later :
       {std::optional<double>(0.003), std::optional<double>()}) {
    twin.fit_errors = FitErrors{1.0 / 3, 0.09, later, 7e-4, 0.05};
    WriteTwin(twin, path_);
    const std::optional<FitErrors> read = ReadTwin(path_).fit_errors;
    ASSERT_TRUE(read);
    EXPECT_EQ(FitErrorsToJson(*read), FitErrorsToJson(*twin.fit_errors));
    EXPECT_EQ(read->later, later);
  }
}

TEST(FitErrors, AreDescribed) {
  FitErrors errors{1.234e-3, 0.05, std::nullopt, 7e-4, 0.05};
  EXPECT_EQ(DescribeFitErrors(errors),
            "on the fit frames: 1.234 mm (a motionless body: 50.000 mm)");
  EXPECT_TRUE(errors.LeavesNoise());
  errors.later = 2e-3;
  errors.correlation = 0.5;
  EXPECT_EQ(
      DescribeFitErrors(errors),
      "on the fit frames: 1.234 mm (a motionless body: 50.000 mm); on the later ones: 2.000 mm");
  EXPECT_FALSE(errors.LeavesNoise());
}

TEST_F(TwinFile, KeepsThePosterior) {
  EXPECT_TRUE(ReadTwin(path_).posterior.empty()) << "files of older programs have none";
  Twin twin = MakeTwin();
  twin.posterior = {Eigen::MatrixXd::Random(2, 3), Eigen::MatrixXd::Random(2, 3),
                    Eigen::VectorXd::Random(2), Eigen::MatrixXd::Random(2, kContactCount),
                    Eigen::MatrixXd::Random(2, EffectValueCount(twin.levels[0].system.effects))};
  WriteTwin(twin, path_);
  const Posterior read = ReadTwin(path_).posterior;
  EXPECT_EQ(read.stiffness, twin.posterior.stiffness);
  EXPECT_EQ(read.loss_time, twin.posterior.loss_time);
  EXPECT_EQ(read.drag, twin.posterior.drag);
  EXPECT_EQ(read.contact, twin.posterior.contact);
  EXPECT_EQ(read.effects, twin.posterior.effects);
  twin.posterior.loss_time.resize(2, 4);
  EXPECT_THROW(WriteTwin(twin, path_), Error) << "there are three springs";
}

TEST_F(TwinFile, KeepsTheLinearPredictor) {
  EXPECT_TRUE(ReadTwin(path_).linear.empty()) << "files of older programs have none";
  Twin twin = MakeTwin();
  const int features = LinearFeatures(twin.levels[0].system.controllers);
  twin.linear = {Eigen::VectorXd::Random(features), Eigen::MatrixXd::Random(features, 4),
                 Eigen::MatrixXd::Random(3 * twin.points, 4),
                 Eigen::VectorXd::Random(3 * twin.points)};
  WriteTwin(twin, path_);
  const LinearPredictor read = ReadTwin(path_).linear;
  EXPECT_EQ(read.feature_mean, twin.linear.feature_mean);
  EXPECT_EQ(read.components, twin.linear.components);
  EXPECT_EQ(read.weights, twin.linear.weights);
  EXPECT_EQ(read.mean, twin.linear.mean);
  twin.linear.weights.resize(3, 4);
  EXPECT_THROW(WriteTwin(twin, path_), Error);
}

TEST_F(TwinFile, KeepsTheGround) {
  Twin twin = MakeTwin();
  EXPECT_FALSE(ReadTwin(path_).ground.known);
  twin.ground = {.known = true, .plane = {}};
  WriteTwin(twin, path_);
  EXPECT_TRUE(ReadTwin(path_).ground.known);
  EXPECT_FALSE(ReadTwin(path_).ground.plane);
  const Eigen::Vector4d plane(0.6, 0, 0.8, -0.25);
  twin.ground.plane = plane;
  WriteTwin(twin, path_);
  arrays_ = ReadNpz(path_);
  EXPECT_EQ(ReadTwin(path_).ground.plane, plane);
  arrays_["ground"] = NpzArray::Doubles({3}, plane.data());
  EXPECT_EQ(ErrorOfChanged(),
            path_ + ": array 'ground' has 3 numbers, expected 4 (a, b, c, d), or none");
  arrays_["ground"] = NpzArray::Doubles({4}, Eigen::Vector4d(1, 0, 1, 0).data());
  EXPECT_NE(ErrorOfChanged().find("expected 1"), std::string::npos);
}

TEST_F(TwinFile, KeepsTheConeOfFriction) {
  Twin twin = MakeTwin();
  EXPECT_EQ(ReadTwin(path_).levels[1].system.contact.surface.cone, FrictionCone::kElliptic);
  twin.levels[1].system.contact.surface.cone = FrictionCone::kPyramidal;
  WriteTwin(twin, path_);
  EXPECT_EQ(ReadTwin(path_).levels[0].system.contact.surface.cone, FrictionCone::kElliptic);
  EXPECT_EQ(ReadTwin(path_).levels[1].system.contact.surface.cone, FrictionCone::kPyramidal);
  arrays_["level0/cone"] = NpzArray::Text("round");
  EXPECT_EQ(ErrorOfChanged(), path_ + ": array 'level0/cone' holds 'round', expected pyramidal");
  // as MuJoCo, which takes no blanks around its keywords
  arrays_["level0/cone"] = NpzArray::Text(" pyramidal");
  EXPECT_EQ(ErrorOfChanged(),
            path_ + ": array 'level0/cone' holds ' pyramidal', expected pyramidal");
}

TEST_F(TwinFile, WritesTheSameBytesAgain) {
  const std::string again = folder_.File("again.twin.npz");
  WriteTwin(ReadTwin(path_), again);
  EXPECT_EQ(ReadFile(again), ReadFile(path_));
}

}  // namespace
}  // namespace physpring

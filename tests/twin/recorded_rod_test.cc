// SPDX-License-Identifier: Apache-2.0
#include "twin/recorded_rod.h"

#include <gtest/gtest.h>

#include "tests/support/recording_file.h"

namespace physpring {
namespace {

// Three points, an interior particle and a controller.
class RodFile : public RecordingFile {
 protected:
  RodFile() { arrays_.erase("order"); }
  void SetEdges(const std::vector<int>& ends) {
    arrays_["rod"] = NpzArray::Ints({ends.size() / 2, 2}, ends.data());
  }
};

TEST_F(RodFile, HasTheEdgesThatAreGiven) {
  SetEdges({3, 0, 1, 3, 3, 2, 4, 2});
  const Recording read = ReadChanged();
  EXPECT_EQ(read.rod.edges, (RodEdges{{0, 3}, {1, 3}, {2, 3}, {2, 4}}));
  EXPECT_EQ(RodJoints(read.rod), 1);
  WriteRecording(read, path_);
  EXPECT_EQ(ReadRecording(path_).rod, read.rod);
  EXPECT_FALSE(ReadNpz(path_).contains("order"));
}

TEST_F(RodFile, AChainIsWrittenAsOrder) {
  SetEdges({0, 1, 1, 2, 2, 3, 3, 4});
  const Recording read = ReadChanged();
  EXPECT_TRUE(IsPlain(read.rod));
  WriteRecording(read, path_);
  EXPECT_EQ(ReadRecording(path_).rod, read.rod);
  EXPECT_FALSE(ReadNpz(path_).contains("rod"));
}

TEST_F(RodFile, ControllersMayBeNoPartOfIt) {
  SetEdges({0, 1, 1, 2, 2, 3});
  const Recording read = ReadChanged();
  EXPECT_EQ(RodParts(read.rod)[4], -1);
  WriteRecording(read, path_);
  EXPECT_EQ(ReadRecording(path_).rod, read.rod);
}

TEST_F(RodFile, WrongEdgesAreNamed) {
  const std::vector<std::pair<std::vector<int>, std::string>> wrong = {
      {{0, 1, 1, 5}, "array 'rod' has an edge from 1 to 5, expected two numbers of 0 to 4"},
      {{0, 1, -1, 2}, "has an edge from -1 to 2"},
      {{0, 0}, "has an edge from 0 to 0"},
      {{0, 1, 1, 2}, "array 'rod' has no edge of interior particle 0"},
      {{0, 1, 2, 3}, "array 'rod' joins point 0 to point 2 by no way"}};
  for (const auto& [ends, message] : wrong) {
    SetEdges(ends);
    EXPECT_NE(ErrorOfChanged().find(message), std::string::npos) << ErrorOfChanged();
  }
  arrays_["rod"] = NpzArray::Ints({6}, std::vector<int>{0, 1, 1, 2, 2, 3}.data());
  EXPECT_NE(ErrorOfChanged().find("expected (edges, 2)"), std::string::npos) << ErrorOfChanged();
  SetEdges({0, 1, 1, 2, 2, 3});
  const Eigen::VectorXd arc = Eigen::VectorXd::LinSpaced(5, 0, 1);
  arrays_["order"] = NpzArray::Doubles({5}, arc.data());
  EXPECT_NE(ErrorOfChanged().find("stands beside 'order'"), std::string::npos);
}

TEST_F(RodFile, NoneJoinsTwoObjects) {
  arrays_["object"] = NpzArray::Ints({4}, std::vector<int>{7, 7, 8, 8}.data());
  SetEdges({0, 1, 2, 3});
  EXPECT_EQ(ReadChanged().rod.edges, (RodEdges{{0, 1}, {2, 3}}));
  SetEdges({0, 1, 1, 2, 2, 3});
  EXPECT_NE(ErrorOfChanged().find("joins point 1 to point 2, which are of two objects"),
            std::string::npos);
  arrays_.erase("rod");
  arrays_["order"] = NpzArray::Doubles({5}, std::vector<double>{0, 0.1, 0.2, 0.3, 0.4}.data());
  const Recording read = ReadChanged();  // the controller is nearest to the second object
  EXPECT_EQ(read.object, (Eigen::Vector<int, 5>(0, 0, 1, 1, 1)));
  EXPECT_EQ(read.rod.edges, (RodEdges{{0, 1}, {2, 3}, {3, 4}}));
  WriteRecording(read, path_);
  EXPECT_EQ(ReadRecording(path_).rod, read.rod);
}

// A hand that is gone, or comes later, does not bend the rod.
TEST_F(RecordingFile, AControllerThatLetsGoIsNoPartOfTheRod) {
  EXPECT_EQ(RodNeighbours(ReadChanged().rod)[4].size(), 1U);
  arrays_["held"] = NpzArray::Ints({4, 1}, std::vector<int>{1, 1, 0, 0}.data());
  const Recording read = ReadChanged();
  EXPECT_EQ(read.rod.edges, (RodEdges{{0, 1}, {1, 2}, {2, 3}}));
  EXPECT_EQ(read.rod.arc.size(), 5);
  WriteRecording(read, path_);
  EXPECT_EQ(ReadRecording(path_).rod, read.rod);
}

}  // namespace
}  // namespace physpring

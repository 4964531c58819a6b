// SPDX-License-Identifier: Apache-2.0
#include "twin/checks/objects.h"

#include <gtest/gtest.h>

#include "tests/support/plain_rope.h"
#include "tests/support/recording_file.h"

namespace physpring {
namespace {

TEST(Objects, OfOneRopeAreNotCounted) { EXPECT_EQ(FindObjects(PlainRope().Record()).size(), 0); }

TEST(Objects, OfTwoRopesAreTwo) {
  const Eigen::VectorXi object = FindObjects(TwoRopes());
  ASSERT_EQ(object.size(), 24);
  for (int i = 0; i < 22; ++i) EXPECT_EQ(object[i], i < 11 ? 0 : 1) << i;
  EXPECT_EQ(object[22], 0);
  EXPECT_EQ(object[23], 1);
}

// Nothing stays together with anything: that is no object, but one that stretches.
TEST(Objects, OfWhatSpreadsAreNotCounted) {
  Recording recording = PlainRope().Record();
  for (int t = 0; t < 120; ++t) recording.points[t] *= 1 + 0.05 * t;
  EXPECT_EQ(FindObjects(recording).size(), 0);
}

// Numbers of any kind, from 0 on by the first particle; controllers go with what they hold.
TEST(Objects, AreAsDeclared) {
  const Recording ropes = TwoRopes();
  Eigen::VectorXi declared(22);
  declared << Eigen::VectorXi::Constant(11, 7), Eigen::VectorXi::Constant(11, -3);
  const Eigen::VectorXi object = DeclaredObjects(ropes, declared);
  ASSERT_EQ(object.size(), 24);
  for (int i = 0; i < 22; ++i) EXPECT_EQ(object[i], i < 11 ? 0 : 1) << i;
  EXPECT_EQ(object[22], 0);
  EXPECT_EQ(object[23], 1);
  EXPECT_EQ(DeclaredObjects(ropes, Eigen::VectorXi::Constant(22, 4)).size(), 0);
}

class DeclaredObjectsFile : public RecordingFile {};

TEST_F(DeclaredObjectsFile, IsReadAndWritten) {
  const std::vector<int> declared{5, 2, 2, 5};
  arrays_["object"] = NpzArray::Ints({declared.size()}, declared.data());
  const Recording read = ReadChanged();
  EXPECT_EQ(read.object.head(4), Eigen::Vector4i(0, 1, 1, 0));
  WriteRecording(read, path_);
  EXPECT_EQ(ReadRecording(path_).object, read.object);
  arrays_["object"] = NpzArray::Ints({3}, declared.data());
  EXPECT_EQ(ErrorOfChanged(),
            path_ + ": array 'object' has the shape (3,), expected (N+M,) with N+M = 4");
}

}  // namespace
}  // namespace physpring

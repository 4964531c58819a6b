// SPDX-License-Identifier: Apache-2.0
// Splats in .ply files: what is written is read, what is no such file is one line.
#include "splats/splat_file.h"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/splats/random_splats.h"
#include "tests/support/temporary_folder.h"
#include "twin/atomic_file.h"
#include "twin/error.h"

namespace physpring {
namespace {

class SplatFileTest : public ::testing::Test {
 protected:
  std::string Path() const { return folder_.File("a.ply"); }

  std::string Refusal(const std::string& bytes) {
    WriteFileAtomically(Path(), bytes);
    try {
      ReadSplats(Path());
    } catch (const Error& error) {
      const std::string line = error.what();
      EXPECT_TRUE(line.starts_with(Path() + ": ")) << line;
      return line.substr(Path().size() + 2);
    }
    return "";
  }

  std::string Bytes(const Splats& splats) {
    WriteSplats(splats, Path());
    return ReadFile(Path());
  }

  static std::string With(std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  }

  TemporaryFolder folder_;
};

TEST_F(SplatFileTest, WhatIsWrittenIsRead) {
  for (int degree = 0; degree <= kMostHarmonicDegree; ++degree) {
    const Splats written = RandomSplats(50, degree, 3);
    WriteSplats(written, Path());
    const Splats read = ReadSplats(Path());
    EXPECT_EQ(read.degree, degree);
    EXPECT_EQ(read.position, written.position);
    EXPECT_EQ(read.log_scale, written.log_scale);
    EXPECT_EQ(read.rotation, written.rotation);
    EXPECT_EQ(read.logit, written.logit);
    EXPECT_EQ(read.harmonics, written.harmonics);
  }
}

// By hand, with the columns in another order, more of them, and lines that end with \r\n.
TEST_F(SplatFileTest, ColumnsAreFoundByTheirNames) {
  std::string text =
      "ply\r\nformat binary_little_endian 1.0\r\ncomment made by hand\r\n"
      "element vertex 1\r\nproperty uchar red\r\n";
  const std::vector<std::string> names = {"opacity", "rot_3",   "rot_2",   "rot_1",  "rot_0",
                                          "scale_0", "scale_1", "scale_2", "f_dc_2", "f_dc_1",
                                          "f_dc_0",  "z",       "y",       "x"};
  for (const std::string& name : names) text += "property float " + name + "\r\n";
  text += "end_header\r\n\x07";
  for (int k = 0; k < 14; ++k) {
    const auto number = static_cast<float>(k);
    char raw[4];
    std::memcpy(raw, &number, 4);
    text.append(raw, 4);
  }
  WriteFileAtomically(Path(), text);
  const Splats read = ReadSplats(Path());
  EXPECT_EQ(read.position, Eigen::Vector3f(13, 12, 11));
  EXPECT_EQ(read.rotation, Eigen::Vector4f(4, 3, 2, 1));
  EXPECT_EQ(read.log_scale, Eigen::Vector3f(5, 6, 7));
  EXPECT_EQ(read.harmonics, Eigen::Vector3f(10, 9, 8));
  EXPECT_EQ(read.logit[0], 0);
}

TEST_F(SplatFileTest, OtherFilesAreRefused) {
  const std::string good = Bytes(RandomSplats(3, 1, 4));
  EXPECT_EQ(Refusal(""), "is no .ply file, or ends within its header");
  EXPECT_EQ(Refusal("solid cube\n"), "is no .ply file");
  EXPECT_EQ(Refusal(With(good, "binary_little_endian", "ascii")),
            "is 'ascii', expected binary_little_endian");
  EXPECT_EQ(Refusal(With(good, "element vertex", "element chunk 1\nelement vertex")),
            "is compressed; convert it to a plain .ply of Gaussians");
  EXPECT_EQ(Refusal(With(good, "float x", "uint packed_position")),
            "is compressed; convert it to a plain .ply of Gaussians");
  EXPECT_EQ(Refusal(With(good, "float opacity", "double opacity")),
            "has no property 'opacity' of type float, so it is no file of splats");
  EXPECT_EQ(Refusal(With(good, "float f_rest_8", "float more")),
            "has 8 properties f_rest_*, expected 0, 9, 24 or 45");
  EXPECT_EQ(Refusal(With(good, "vertex 3", "vertex 10000000")),
            "has 10000000 splats, expected at most 4000000");
  EXPECT_EQ(Refusal(With(good, "vertex 3", "vertex -3")), "has '-3' splats, expected 1 or more");
}

TEST_F(SplatFileTest, WhatIsCutShortIsRefused) {
  const std::string good = Bytes(RandomSplats(3, 0, 4));
  EXPECT_EQ(Refusal(good.substr(0, good.size() - 1)),
            "is cut short: 3 splats of 68 bytes, but 203 bytes are there");
  const std::size_t end = good.find("end_header\n") + 11;
  for (std::size_t length = 0; length < end; ++length) {
    EXPECT_NE(Refusal(good.substr(0, length)), "") << length;
  }
  EXPECT_EQ(Refusal(With(good, "vertex 3", "vertex 4000000")).substr(0, 39),
            "is cut short: 4000000 splats of 68 byte");
}

TEST_F(SplatFileTest, NumbersThatNoSplatHasAreRefused) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Splats splats = RandomSplats(3, 0, 4);
  splats.position(1, 2) = nan;
  EXPECT_EQ(Refusal(Bytes(splats)), "splat 2 has a position that is not finite, or far off");
  splats = RandomSplats(3, 0, 4);
  splats.log_scale(0, 1) = 50;
  EXPECT_EQ(Refusal(Bytes(splats)), "splat 1 has a scale that is not a number, or huge");
  splats = RandomSplats(3, 0, 4);
  splats.rotation.col(0).setZero();
  EXPECT_EQ(Refusal(Bytes(splats)), "splat 0 has a rotation that is none");
  splats = RandomSplats(3, 0, 4);
  splats.logit[0] = nan;
  EXPECT_EQ(Refusal(Bytes(splats)), "splat 0 has an opacity that is not a number");
  splats = RandomSplats(3, 0, 4);
  splats.harmonics(0, 0) = nan;
  EXPECT_EQ(Refusal(Bytes(splats)), "splat 0 has a colour that is not finite, or huge");
}

TEST_F(SplatFileTest, FlatAndOpaqueSplatsMayBeInfinitelySo) {
  const float infinity = std::numeric_limits<float>::infinity();
  Splats splats = RandomSplats(2, 0, 4);
  splats.log_scale(2, 0) = -infinity;
  splats.logit[1] = infinity;
  WriteSplats(splats, Path());
  const Splats read = ReadSplats(Path());
  EXPECT_EQ(read.log_scale(2, 0), -20);
  EXPECT_EQ(read.logit[1], 1e4F);
}

}  // namespace
}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
#include "pictures/png_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"
#include "twin/atomic_file.h"
#include "twin/error.h"

namespace physpring {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class PngFile : public ::testing::Test {
 protected:
  template <class Act>
  std::string MessageOf(const Act& act) {
    try {
      act();
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing is refused";
  }

  const TemporaryFolder folder_;
  const std::string path_ = folder_.File("a.png");
};

TEST_F(PngFile, ColoursComeBack) {
  Image image{5, 3, {}};
  for (int i = 0; i < 45; ++i) image.rgb.push_back(static_cast<unsigned char>(17 * i));
  WritePng(image, path_);
  EXPECT_EQ(ReadColours(path_, 5, 3).rgb, image.rgb);
}

TEST_F(PngFile, MasksComeBack) {
  const Mask mask{3, 2, {kElsewhere, kHidden, kObject, kObject, kElsewhere, kHidden}};
  WritePng(mask, path_);
  EXPECT_EQ(ReadMask(path_, 3, 2).kind, mask.kind);
}

TEST_F(PngFile, DepthsComeBackInTheirUnits) {
  const DepthImage depth{4, 1, {0, 1.23456F, 6.5535F, 7}};
  WritePng(depth, 1e-4, path_);
  const DepthImage found = ReadDepth(path_, 4, 1, 1e-4);
  EXPECT_EQ(found.metres[0], 0);
  EXPECT_NEAR(found.metres[1], 1.2346, 1e-6);
  EXPECT_NEAR(found.metres[2], 6.5535, 1e-6);
  EXPECT_EQ(found.metres[3], 0);  // too far
}

// libpng would take 128 for another number where a file says how bright it is.
TEST_F(PngFile, NumbersAreAsStoredWhateverTheColourSpace) {
  WritePng(Mask{2, 1, {kHidden, kObject}}, path_);
  const std::string plain = ReadFile(path_);
  const std::string gamma("\0\0\0\x04gAMA\0\x01\x86\xa0\x31\xe8\x96\x5f", 16);  // 1.0
  const std::size_t after_header = 8 + 12 + 13;
  WriteFileAtomically(path_, plain.substr(0, after_header) + gamma + plain.substr(after_header));
  EXPECT_EQ(ReadMask(path_, 2, 1).kind[0], kHidden);
}

TEST_F(PngFile, RefusesWhatIsNotExpected) {
  WritePng(Image{4, 4, std::vector<unsigned char>(48, 90)}, path_);
  EXPECT_THAT(MessageOf([&] { ReadColours(path_, 4, 5); }),
              HasSubstr("has 4 x 4 pixels; 4 x 5 are expected"));
  EXPECT_THAT(MessageOf([&] { ReadDepth(path_, 4, 4, 1e-4); }),
              HasSubstr("has 8 bits a channel; 16 are expected"));
  EXPECT_THAT(MessageOf([&] { ReadMask(path_, 4, 4); }),
              HasSubstr("has a pixel of 90; a mask has"));
  WriteFileAtomically(path_, "");
  EXPECT_THAT(MessageOf([&] { ReadColours(path_, 4, 4); }), HasSubstr("is empty"));
  EXPECT_THAT(MessageOf([&] { ReadColours(folder_.File("none.png"), 4, 4); }),
              StartsWith(folder_.File("none.png")));
}

TEST_F(PngFile, RefusesDamage) {
  WritePng(Image{40, 40, std::vector<unsigned char>(4800, 90)}, path_);
  const std::string whole = ReadFile(path_);
  for (std::size_t length : {std::size_t{7}, std::size_t{30}, whole.size() / 2}) {
    WriteFileAtomically(path_, whole.substr(0, length));
    EXPECT_THAT(MessageOf([&] { ReadColours(path_, 40, 40); }), HasSubstr("is no sound .png file"))
        << length;
  }
  std::string broken = whole;
  broken[whole.size() / 2] = static_cast<char>(broken[whole.size() / 2] ^ 0x55);
  WriteFileAtomically(path_, broken);
  EXPECT_THAT(MessageOf([&] { ReadColours(path_, 40, 40); }), HasSubstr("is no sound .png file"));
}

}  // namespace
}  // namespace physpring

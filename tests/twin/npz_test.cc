// SPDX-License-Identifier: Apache-2.0
#include "twin/npz.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zip.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/support/file_damage.h"
#include "tests/support/temporary_folder.h"
#include "twin/atomic_file.h"
#include "twin/error.h"
#include "twin/npy.h"

namespace physpring {
namespace {

const std::string kTestData = PHYSPRING_SOURCE_DIR "/tests/twin/testdata/";

NpzArray Bytes(const std::string& type, std::vector<std::size_t> shape, const std::string& data) {
  return {type, std::move(shape), {data.begin(), data.end()}};
}

// A .npy array of any header.
std::string Npy(const std::string& dictionary, const std::string& values, int version = 1) {
  std::string bytes = "\x93NUMPY";
  bytes += static_cast<char>(version);
  bytes += '\0';
  for (int i = 0; i < (version == 1 ? 2 : 4); ++i) {
    bytes += static_cast<char>(dictionary.size() >> 8 * i & 255);
  }
  return bytes + dictionary + values;
}

// A zip archive of any members.
void WriteZip(const std::string& path,
              const std::vector<std::pair<std::string, std::string>>& members,
              zip_int32_t method = ZIP_CM_STORE) {
  zip_t* const archive = zip_open(path.c_str(), ZIP_CREATE | ZIP_TRUNCATE, nullptr);
  ASSERT_NE(archive, nullptr);
  for (const auto& [name, bytes] : members) {
    zip_source_t* const source = zip_source_buffer(archive, bytes.data(), bytes.size(), 0);
    const zip_int64_t index = zip_file_add(archive, name.c_str(), source, 0);
    ASSERT_GE(index, 0);
    zip_set_file_compression(archive, static_cast<zip_uint64_t>(index), method, 0);
  }
  ASSERT_EQ(zip_close(archive), 0);
}

// A small archive with several types and shapes.
Npz MakeArrays() {
  const std::vector<double> values{1.0 / 3, -0.0, 1e300, -2.5, 0, 7};
  const std::vector<int> whole{-1, 2147483647};
  return {{"doubles", NpzArray::Doubles({2, 3}, values.data())},
          {"floats", NpzArray::Floats({6}, values.data())},
          {"ints", NpzArray::Ints({2}, whole.data())},
          {"level0/text", NpzArray::Text("{\"a\": 1}")},
          {"none", NpzArray::Doubles({0, 3}, nullptr)},
          {"scalar", NpzArray::Doubles({}, values.data())}};
}

class NpzFile : public testing::Test {
 protected:
  TemporaryFolder folder_;
  std::string path_ = folder_.File("arrays.npz");
};

TEST_F(NpzFile, ReadsBackWhatWasWritten) {
  WriteNpz(MakeArrays(), path_);
  EXPECT_EQ(ReadNpz(path_), MakeArrays());
}

TEST_F(NpzFile, WritesEqualBytesForEqualContent) {
  WriteNpz(MakeArrays(), path_);
  const std::string first = ReadFile(path_);
  WriteNpz(MakeArrays(), path_);
  EXPECT_EQ(ReadFile(path_), first);
}

class NumpyArchive : public testing::TestWithParam<const char*> {};

TEST_P(NumpyArchive, IsReadAsNumpyWroteIt) {
  Npz arrays = ReadNpz(kTestData + GetParam());
  EXPECT_EQ(arrays.size(), 16u);
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(arrays["f2"].ToDoubles(),
            (std::vector<double>{1.5, -0.25, 65504, std::ldexp(1, -24), infinity, -0.0}));
  EXPECT_TRUE(std::signbit(arrays["f2"].ToDoubles()[5]));
  const std::vector<double> f4 = arrays["f4"].ToDoubles();
  EXPECT_EQ(f4[0], static_cast<double>(0.1f));
  EXPECT_TRUE(std::isnan(f4[1]));
  EXPECT_EQ(arrays["f4"].shape, (std::vector<std::size_t>{1, 3}));
  EXPECT_EQ(arrays["f8"].ToDoubles(), (std::vector<double>{1.0 / 3, -1e300}));
  EXPECT_EQ(arrays["f8"].shape, (std::vector<std::size_t>{2, 1, 1}));
  EXPECT_EQ(arrays["i1"].ToInts(), (std::vector<int>{-128, 127}));
  EXPECT_EQ(arrays["i2"].ToInts(), (std::vector<int>{-32768, 32767}));
  EXPECT_EQ(arrays["i4"].ToInts(), (std::vector<int>{-2147483647, 2147483647}));
  EXPECT_EQ(arrays["i8"].ToDoubles(), (std::vector<double>{-0x1p53, 0x1p53}));
  EXPECT_EQ(arrays["u1"].ToText(), "text");
  EXPECT_EQ(arrays["u2"].ToInts(), (std::vector<int>{65535}));
  EXPECT_EQ(arrays["u4"].ToDoubles(), (std::vector<double>{4294967295.0}));
  EXPECT_EQ(arrays["u8"].ToDoubles(), (std::vector<double>{0x1p53}));
  EXPECT_EQ(arrays["b1"].ToInts(), (std::vector<int>{1, 0}));
  EXPECT_EQ(arrays["scalar"].ToDoubles(), (std::vector<double>{29.97}));
  EXPECT_EQ(arrays["empty"].shape, (std::vector<std::size_t>{0, 3}));
  EXPECT_EQ(arrays["fortran"].ToDoubles(), (std::vector<double>{1, 2}));
  EXPECT_EQ(arrays["level0/nested"].ToInts(), (std::vector<int>{7}));
}

INSTANTIATE_TEST_SUITE_P(, NumpyArchive, testing::Values("numpy_stored.npz", "numpy_deflated.npz"));

TEST(NpzArray, ConvertsOnlyWhatHasTheMeaning) {
  const double half = 0.5, nan = std::nan(""), large = 2147483648.0;
  EXPECT_THROW(NpzArray::Doubles({}, &half).ToInts(), Error);
  EXPECT_THROW(NpzArray::Doubles({}, &nan).ToInts(), Error);
  EXPECT_THROW(NpzArray::Doubles({}, &large).ToInts(), Error);
  EXPECT_THROW(NpzArray::Doubles({}, &half).ToText(), Error);
  EXPECT_THROW(Bytes("|u1", {}, "a").ToText(), Error);
  EXPECT_EQ(Bytes("<f2", {2}, std::string("\x01\x7e\x00\xfc", 4)).ToDoubles()[1],
            -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(Bytes("<f2", {1}, "\x01\x7e").ToDoubles()[0]));
}

TEST_F(NpzFile, ReadsEveryVersionOfTheArrayHeader) {
  const std::string text = "{'descr': '|u1', 'fortran_order': False, 'shape': (2,), }\n";
  const std::string other = "{\"shape\":(2,),\"fortran_order\":True,\"descr\":\"|u1\"}";
  WriteZip(path_, {{"v1.npy", Npy(text, "ab", 1)},
                   {"v2.npy", Npy(text, "ab", 2)},
                   {"v3.npy", Npy(other, "ab", 3)}});
  Npz arrays = ReadNpz(path_);
  for (const char* name : {"v1", "v2", "v3"}) EXPECT_EQ(arrays[name].ToText(), "ab") << name;
}

TEST_F(NpzFile, RefusesWhatIsNoPlainArray) {
  const auto header = [](const std::string& type, const std::string& shape,
                         const std::string& fortran = "False") {
    return fmt::format("{{'descr': {}, 'fortran_order': {}, 'shape': {}}}", type, fortran, shape);
  };
  const std::string values(24, '\0');
  const std::vector<std::pair<std::string, const char*>> cases{
      {"", "is not a .npy array"},
      {"\x93NUMP", "is not a .npy array"},
      {"PK plain text here", "is not a .npy array"},
      {Npy(header("'<f4'", "(6,)"), values, 4), "has .npy version 4.0, expected 1.0 to 3.0"},
      {Npy(header("'<f4'", "(6,)"), values).substr(0, 30), "declares a .npy header of"},
      {Npy(header("'<f4'", "(5,)"), values), "has the shape (5,) of type '<f4' but 24 bytes"},
      {Npy(header("'<f4'", "(6, 2)"), values), "has the shape (6, 2)"},
      {Npy(header("'<f8'", "()"), values), "has the shape () of type '<f8' but 24 bytes"},
      {Npy(header("'<f8'", "(0, 3)"), values), "has the shape (0, 3)"},
      {Npy(header("'<f8'", "(2147483647, 2147483647, 2147483647, 3)"), values),
       "has the shape (21"},
      {Npy(header("'<f8'", "(2147483648, 0)"), values),
       "has a shape with the extent 2147483648, expected up to 32 extents below 2^31"},
      {Npy(header("'<f8'", "(" + fmt::format("{}", fmt::join(std::vector(33, 1), ",")) + ")"),
           values),
       "has a shape with more dimensions, expected up to 32"},
      {Npy(header("'<f8'", "(99999999999999999999,)"), values), "malformed .npy header"},
      {Npy(header("'<f8'", "(-3,)"), values), "malformed .npy header"},
      {Npy(header("'<f8'", "(3)"), values), "malformed .npy header"},
      {Npy(header("'<f8'", "3"), values), "malformed .npy header"},
      {Npy(header("'<f8'", "(3,"), values), "malformed .npy header"},
      {Npy(header("'<f8", "(3,)"), values), "has the type"},
      {Npy(header("'<f8'", "(3,)", "None"), values), "malformed .npy header"},
      {Npy(header("'<f8'", "(3,)") + "x", values), "malformed .npy header"},
      {Npy("{'descr': '<f8', 'shape': (3,)}", values), "malformed .npy header"},
      {Npy("{'descr': '<f8', 'descr': '<f8'}", values), "malformed .npy header"},
      {Npy("{'descr': '<f8', 'extra': 1}", values), "malformed .npy header"},
      {Npy("", values), "malformed .npy header"},
      {Npy(header("'>f8'", "(3,)"), values), "has the big-endian type '>f8'"},
      {Npy(header("'|O'", "(3,)"), values), "has the type '|O', expected numbers such as"},
      {Npy(header("'<U3\n'", "(2,)"), values), "has the type '<U3?'"},
      {Npy(header("'<c16'", "()"), values), "has the type '<c16'"},
      {Npy(header("[('x', '<f8')]", "(3,)"), values), "is a structured array"},
      {Npy(header("'<f4'", "(3, 2)", "True"), values), "is in Fortran order, expected C order"},
  };
  for (const auto& [bytes, message] : cases) {
    WriteZip(path_, {{"x.npy", bytes}});
    const std::string error = ErrorOf(path_, [this] { ReadNpz(path_); });
    EXPECT_NE(error.find(message), std::string::npos) << error << ", expected " << message;
    EXPECT_NE(error.find("array 'x'"), std::string::npos) << error;
  }
}

TEST_F(NpzFile, RefusesWhatIsNoArchiveOfArrays) {
  const auto error_of_zip = [this](const std::string& name, zip_int32_t method) {
    WriteZip(path_, {{name, Npy("{'descr': '|u1', 'fortran_order': False, 'shape': (0,)}", "")}},
             method);
    return ErrorOf(path_, [this] { ReadNpz(path_); });
  };
  EXPECT_NE(error_of_zip("read\nme.txt", ZIP_CM_STORE).find("'read?me.txt' is not a .npy array"),
            std::string::npos);
  if (zip_compression_method_supported(ZIP_CM_BZIP2, 1)) {
    EXPECT_NE(error_of_zip("x.npy", ZIP_CM_BZIP2).find("expected stored or deflated"),
              std::string::npos);
  }
  const auto error_of_bytes = [this](const std::string& bytes) {
    Overwrite(path_, bytes);
    return ErrorOf(path_, [this] { ReadNpz(path_); });
  };
  EXPECT_NE(error_of_bytes("").find("holds no arrays"), std::string::npos);
  EXPECT_NE(error_of_bytes("points").find("is not a complete .npz archive"), std::string::npos);
  EXPECT_NE(ErrorOf(folder_.path(), [this] { ReadNpz(folder_.path()); }).find("Is a directory"),
            std::string::npos);
  const std::string absent = folder_.File("absent.npz");
  EXPECT_NE(ErrorOf(absent, [&] { ReadNpz(absent); }).find("No such file"), std::string::npos);
}

TEST_F(NpzFile, EveryDamageIsRefusedWhenDeflated) {
  WriteNpz(MakeArrays(), path_);
  ExpectEveryDamageIsRefused(path_, [this] { ReadNpz(path_); });
}

TEST_F(NpzFile, EveryDamageIsRefusedWhenStored) {
  const NpyHeader header{"<f4", {2, 3}};
  WriteZip(path_, {{"a.npy", FormatNpyHeader(header) + std::string(24, '\x3f')},
                   {"b.npy", FormatNpyHeader(header) + std::string(24, '\x40')}});
  ExpectEveryDamageIsRefused(path_, [this] { ReadNpz(path_); });
}

// A member that would unpack to far more than its shape says, or than its file could hold.
TEST_F(NpzFile, RefusesToUnpackBombs) {
  const std::string header = FormatNpyHeader({"<f8", {3}});
  WriteZip(path_, {{"x.npy", header + std::string(64 << 20, '\0')}}, ZIP_CM_DEFLATE);
  EXPECT_LT(ReadFile(path_).size(), 100000u);
  EXPECT_NE(ErrorOf(path_, [this] { ReadNpz(path_); }).find("has the shape (3,) of type '<f8' but"),
            std::string::npos);

  // the size that the directory declares becomes 2 GiB
  const std::string array = header + std::string(24, '\0');
  WriteZip(path_, {{"x.npy", array}});
  std::string bytes = ReadFile(path_);
  const std::string size{static_cast<char>(array.size()), 0, 0, 0};
  const std::string declared{0, 0, 0, '\x7f'};
  for (std::size_t at = bytes.find(size + size); at != std::string::npos;
       at = bytes.find(size + size)) {
    bytes.replace(at, 8, size + declared);
  }
  Overwrite(path_, bytes);
  EXPECT_NE(ErrorOf(path_, [this] { ReadNpz(path_); }).find("array 'x'"), std::string::npos);
}

// What is held is counted: three arrays of zeros, of 12 MiB each in the file's types, are 288 MiB
// as doubles. Stored, the file itself is large enough for them.
TEST_F(NpzFile, CountsValuesAsDoubles) {
  constexpr std::size_t kValues = 12 << 20;
  const std::string array = FormatNpyHeader({"|u1", {kValues}}) + std::string(kValues, '\0');
  WriteZip(path_, {{"a.npy", array}, {"b.npy", array}}, ZIP_CM_DEFLATE);
  EXPECT_EQ(ReadNpz(path_).size(), 2u);
  WriteZip(path_, {{"a.npy", array}, {"b.npy", array}, {"c.npy", array}}, ZIP_CM_DEFLATE);
  EXPECT_EQ(ErrorOf(path_, [this] { ReadNpz(path_); }),
            path_ + ": array 'c' has 12582912 values, more than are read of a file of this size");
  WriteZip(path_, {{"a.npy", array}, {"b.npy", array}, {"c.npy", array}});
  EXPECT_EQ(ReadNpz(path_).size(), 3u);
}

// What is written can be read, however well it would pack.
TEST_F(NpzFile, StoresWhatWouldPackTooWell) {
  const std::string zeros((32 << 20) + 1, '\0');
  const Npz arrays{{"zeros", NpzArray::Text(zeros)}};
  WriteNpz(arrays, path_);
  EXPECT_TRUE(ReadNpz(path_) == arrays);
}

// Many bytes of the archive change at random, others are cut out or doubled.
TEST(NpzArchive, SurvivesRandomChanges) {
  std::mt19937 random(1);
  const Npz arrays = MakeArrays();
  const std::string sound = PackNpz(arrays, "x");
  for (int trial = 0; trial < 5000; ++trial) {
    std::string bytes = sound;
    for (std::size_t changes = 1 + random() % 4; changes > 0; --changes) {
      const std::size_t at = random() % bytes.size();
      const std::size_t length = std::min<std::size_t>(1 + random() % 8, bytes.size() - at);
      if (random() % 4 > 0) {
        bytes[at] = static_cast<char>(random());
      } else if (random() % 2 > 0) {
        bytes.erase(at, length);
      } else {
        bytes.insert(at, bytes.substr(at, length));
      }
    }
    try {
      EXPECT_EQ(ParseNpz(bytes, "x"), arrays);
    } catch (const Error& error) {
      ExpectOneLine("x", error.what());
    }
  }
}

// The header of an array changes at random under a right checksum.
TEST(NpyHeader, SurvivesRandomChanges) {
  std::mt19937 random(2);
  const std::string sound = FormatNpyHeader({"<f4", {120, 76, 3}});
  const std::string alphabet = "{}()[],:'\" <>|f48iu0123456789TrueFalse\n";
  int accepted = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    std::string bytes = sound;
    for (std::size_t changes = 1 + random() % 3; changes > 0; --changes) {
      const std::size_t at = random() % bytes.size();
      bytes[at] =
          random() % 2 > 0 ? alphabet[random() % alphabet.size()] : static_cast<char>(random());
    }
    try {
      const NpyHeader header = ParseNpyHeader(bytes);
      EXPECT_GT(BytesOfType(header.type), 0u);
      ++accepted;
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
  EXPECT_GT(accepted, 0);  // the changes are not all hopeless
}

TEST_F(NpzFile, HashTellsFilesApart) {
  Overwrite(path_, "");
  EXPECT_EQ(HashFile(path_), "cbf29ce484222325");  // FNV-1a's published values
  Overwrite(path_, "a");
  EXPECT_EQ(HashFile(path_), "af63dc4c8601ec8c");
  Overwrite(path_, "foobar");
  EXPECT_EQ(HashFile(path_), "85944171f73967e8");
}

}  // namespace
}  // namespace physpring

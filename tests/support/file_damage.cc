// SPDX-License-Identifier: Apache-2.0
#include "tests/support/file_damage.h"

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <limits>

#include "twin/atomic_file.h"
#include "twin/error.h"
#include "twin/npy.h"

namespace physpring {
namespace {

std::size_t Draw(std::mt19937& random, std::size_t count) { return random() % count; }

// One value becomes one that is easily forgotten.
void MutateValue(NpzArray& array, std::mt19937& random) {
  if (array.size() == 0) return;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr std::array<double, 10> kValues{
      std::numeric_limits<double>::quiet_NaN(),  kInfinity,   -kInfinity, 0, -1, 1, 1e300, -1e300,
      std::numeric_limits<double>::denorm_min(), 2147483648.0};
  std::vector<double> values = array.ToDoubles();
  values[Draw(random, values.size())] = kValues[Draw(random, kValues.size())];
  array = NpzArray::Doubles(array.shape, values.data());
}

void MutateByte(NpzArray& array, std::mt19937& random) {
  if (array.data.empty()) return;
  array.data[Draw(random, array.data.size())] ^= static_cast<unsigned char>(1 + Draw(random, 255));
}

void MutateShape(NpzArray& array, std::mt19937& random) {
  if (Draw(random, 2) == 0 && !array.shape.empty()) {
    array.shape[Draw(random, array.shape.size())] = Draw(random, 6);
  } else if (Draw(random, 2) == 0 && !array.shape.empty()) {
    array.shape.pop_back();
  } else {
    array.shape.push_back(Draw(random, 4));
  }
}

void MutateType(NpzArray& array, std::mt19937& random) {
  constexpr std::array<const char*, 12> kTypes{"<f2", "<f4", "<f8", "|i1", "<i2", "<i4",
                                               "<i8", "|u1", "<u2", "<u4", "<u8", "|b1"};
  array.type = kTypes[Draw(random, kTypes.size())];
}

}  // namespace

void ExpectOneLine(const std::string& path, const std::string& message) {
  EXPECT_TRUE(message.starts_with(path + ": ")) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

void Overwrite(const std::string& path, const std::string& bytes) {
  std::filesystem::remove(path);  // some file systems sync a file that is cut to nothing
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

void MutateArrays(Npz& arrays, std::mt19937& random) {
  for (std::size_t change = Draw(random, 3) + 1; change > 0 && !arrays.empty(); --change) {
    auto chosen = arrays.begin();
    std::advance(chosen, Draw(random, arrays.size()));
    NpzArray& array = chosen->second;
    switch (Draw(random, 8)) {
      case 0:
        arrays.erase(chosen);
        continue;
      case 1:
        arrays[chosen->first + "x"] = array;
        continue;
      case 2:
        MutateShape(array, random);
        break;
      case 3:
        MutateType(array, random);
        break;
      case 4:
      case 5:
        MutateByte(array, random);
        break;
      default:
        MutateValue(array, random);
    }
    array.data.resize(array.size() * BytesOfType(array.type));
  }
}

std::string ErrorOf(const std::string& path, const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    ExpectOneLine(path, error.what());
    return error.what();
  }
  ADD_FAILURE() << path << ": no error";
  return "";
}

bool operator==(const NpzArray& a, const NpzArray& b) {
  return a.type == b.type && a.shape == b.shape && a.data == b.data;
}

void ExpectEveryDamageIsRefused(const std::string& path, const std::function<void()>& read) {
  const std::string sound = ReadFile(path);
  const Npz arrays = ReadNpz(path);
  for (std::size_t length = 0; length < sound.size(); ++length) {
    SCOPED_TRACE("cut to " + std::to_string(length) + " bytes");
    Overwrite(path, sound.substr(0, length));
    ErrorOf(path, read);
  }
  for (std::size_t i = 0; i < sound.size(); ++i) {
    for (const int change : {255, 1 << i % 8}) {
      SCOPED_TRACE("byte " + std::to_string(i) + " changed by " + std::to_string(change));
      std::string damaged = sound;
      damaged[i] = static_cast<char>(damaged[i] ^ change);
      Overwrite(path, damaged);
      try {
        read();
        EXPECT_EQ(ReadNpz(path), arrays);
      } catch (const Error& error) {
        ExpectOneLine(path, error.what());
      }
    }
  }
  Overwrite(path, sound);
  EXPECT_NO_THROW(read());
}

}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
// The values of an NpzArray as doubles, integers and text, and back.
#include <fmt/format.h>

#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>

#include "twin/error.h"
#include "twin/npy.h"
#include "twin/npz.h"

namespace physpring {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are copied byte by byte");

// A value of IEEE 754 binary16: sign, 5 bits of exponent (bias 15), 10 bits of fraction.
struct Half {
  std::uint16_t bits;

  explicit operator double() const {
    const int exponent = bits >> 10 & 31;
    const int fraction = bits & 1023;
    double magnitude = std::ldexp(1024 + fraction, exponent - 25);
    if (exponent == 0) magnitude = std::ldexp(fraction, -24);
    if (exponent == 31) {
      magnitude = fraction ? std::numeric_limits<double>::quiet_NaN()
                           : std::numeric_limits<double>::infinity();
    }
    return bits >> 15 ? -magnitude : magnitude;
  }
};

template <typename T>
void Convert(const unsigned char* data, std::size_t count, double* values) {
  for (std::size_t i = 0; i < count; ++i) {
    T value;
    std::memcpy(&value, data + i * sizeof(T), sizeof(T));
    values[i] = static_cast<double>(value);
  }
}

template <typename T, typename Value>
NpzArray Store(const char* type, std::vector<std::size_t> shape, const Value* values) {
  NpzArray array{type, std::move(shape), {}};
  array.data.resize(array.size() * sizeof(T));
  for (std::size_t i = 0; i < array.size(); ++i) {
    const T value = static_cast<T>(values[i]);
    std::memcpy(array.data.data() + i * sizeof(T), &value, sizeof(T));
  }
  return array;
}

}  // namespace

std::size_t NpzArray::size() const { return CountOfShape(shape).value(); }

NpzArray NpzArray::Doubles(std::vector<std::size_t> shape, const double* values) {
  return Store<double>("<f8", std::move(shape), values);
}

NpzArray NpzArray::Floats(std::vector<std::size_t> shape, const double* values) {
  return Store<float>("<f4", std::move(shape), values);
}

NpzArray NpzArray::Ints(std::vector<std::size_t> shape, const int* values) {
  return Store<std::int32_t>("<i4", std::move(shape), values);
}

NpzArray NpzArray::Text(const std::string& text) {
  return Store<unsigned char>("|u1", {text.size()}, text.data());
}

std::vector<double> NpzArray::ToDoubles() const {
  std::vector<double> values(size());
  CopyDoubles(0, values.size(), values.data());
  return values;
}

void NpzArray::CopyDoubles(std::size_t first, std::size_t count, double* values) const {
  assert(first + count <= size());
  const unsigned char* const from = data.data() + first * BytesOfType(type);
  if (type == "<f2") return Convert<Half>(from, count, values);
  if (type == "<f4") return Convert<float>(from, count, values);
  if (type == "<f8") return Convert<double>(from, count, values);
  if (type == "|i1") return Convert<std::int8_t>(from, count, values);
  if (type == "<i2") return Convert<std::int16_t>(from, count, values);
  if (type == "<i4") return Convert<std::int32_t>(from, count, values);
  if (type == "<i8") return Convert<std::int64_t>(from, count, values);
  if (type == "|u1" || type == "|b1") return Convert<std::uint8_t>(from, count, values);
  if (type == "<u2") return Convert<std::uint16_t>(from, count, values);
  if (type == "<u4") return Convert<std::uint32_t>(from, count, values);
  if (type == "<u8") return Convert<std::uint64_t>(from, count, values);
  throw Error(fmt::format("has the type '{}', expected numbers", type));
}

std::vector<int> NpzArray::ToInts() const {
  std::vector<int> whole;
  whole.reserve(size());
  for (const double value : ToDoubles()) {
    if (!(std::abs(value) <= std::numeric_limits<int>::max()) || value != std::floor(value)) {
      throw Error(fmt::format("holds {}, expected whole numbers", value));
    }
    whole.push_back(static_cast<int>(value));
  }
  return whole;
}

std::string NpzArray::ToText() const {
  if (type != "|u1" || shape.size() != 1) {
    throw Error(fmt::format("has the type '{}' and the shape {}, expected text: '|u1' and (n,)",
                            type, FormatShape(shape)));
  }
  return std::string(data.begin(), data.end());
}

}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
#include "twin/npy.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cstdint>
#include <limits>
#include <utility>

#include "twin/error.h"
#include "twin/quote.h"

namespace physpring {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr std::size_t kMostDimensions = 32;  // as numpy's
constexpr std::size_t kLargestExtent = std::numeric_limits<std::int32_t>::max();

// Reads the dictionary literal that numpy writes, for example
//   {'descr': '<f4', 'fortran_order': False, 'shape': (120, 76, 3), }
class DictionaryParser {
 public:
  explicit DictionaryParser(std::string_view text) : rest_(text) {}

  NpyHeader Parse() {
    Expect("{");
    while (!Accept("}")) {
      ParseItem();
      if (!Accept(",")) {
        Expect("}");
        break;
      }
    }
    SkipSpace();
    if (!rest_.empty()) Fail();
    if (!type_ || !fortran_order_ || !shape_) Fail();
    if (*fortran_order_ && shape_->size() > 1) {
      throw Error("is in Fortran order, expected C order (numpy.ascontiguousarray)");
    }
    return {*type_, *shape_};
  }

 private:
  [[noreturn]] static void Fail() { throw Error("has a malformed .npy header"); }

  void SkipSpace() {
    while (!rest_.empty() && (rest_[0] == ' ' || rest_[0] == '\n')) rest_.remove_prefix(1);
  }

  bool Accept(std::string_view token) {
    SkipSpace();
    if (!rest_.starts_with(token)) return false;
    rest_.remove_prefix(token.size());
    return true;
  }

  void Expect(std::string_view token) {
    if (!Accept(token)) Fail();
  }

  std::string_view ParseString() {
    const std::string_view quote = Accept("'") ? "'" : "\"";
    if (quote == "\"") Expect(quote);
    const std::size_t end = rest_.find(quote);
    if (end == std::string_view::npos) Fail();
    const std::string_view text = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    return text;
  }

  void ParseItem() {
    const std::string_view key = ParseString();
    Expect(":");
    if (key == "descr" && !type_) {
      type_ = ParseType();
    } else if (key == "fortran_order" && !fortran_order_) {
      fortran_order_ = Accept("True");
      if (!*fortran_order_) Expect("False");
    } else if (key == "shape" && !shape_) {
      shape_ = ParseShape();
    } else {
      Fail();
    }
  }

  std::string ParseType() {
    SkipSpace();
    if (rest_.starts_with('[')) throw Error("is a structured array, expected plain numbers");
    const std::string_view type = ParseString();
    if (BytesOfType(type) > 0) return std::string(type);
    if (type.starts_with('>')) {
      throw Error(fmt::format("has the big-endian type {}, expected little endian", Quote(type)));
    }
    throw Error(fmt::format(
        "has the type {}, expected numbers such as '<f4', '<f8', '<i4' or '|u1'", Quote(type)));
  }

  std::vector<std::size_t> ParseShape() {
    Expect("(");
    std::vector<std::size_t> shape;
    while (!Accept(")")) {
      SkipSpace();
      std::size_t extent = 0;
      const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), extent);
      if (error != std::errc()) Fail();
      rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
      if (extent > kLargestExtent || shape.size() == kMostDimensions) {
        throw Error(fmt::format(
            "has a shape with {}, expected up to {} extents below 2^31",
            extent > kLargestExtent ? fmt::format("the extent {}", extent) : "more dimensions",
            kMostDimensions));
      }
      shape.push_back(extent);
      if (!Accept(",")) {
        if (shape.size() == 1) Fail();  // (4) is a number, (4,) a shape
        Expect(")");
        break;
      }
    }
    return shape;
  }

  std::string_view rest_;
  std::optional<std::string> type_;
  std::optional<bool> fortran_order_;
  std::optional<std::vector<std::size_t>> shape_;
};

unsigned char Byte(std::string_view bytes, std::size_t i) {
  return static_cast<unsigned char>(bytes[i]);
}

// Bytes before the dictionary: magic, version, and the header length in 2 (version 1) or 4 bytes.
std::size_t PreambleLength(std::string_view bytes) {
  if (bytes.size() < 10 || !bytes.starts_with(kMagic)) throw Error("is not a .npy array");
  const int major = Byte(bytes, 6);
  if (major < 1 || major > 3 || bytes[7] != 0) {
    throw Error(fmt::format("has .npy version {}.{}, expected 1.0 to 3.0", major, Byte(bytes, 7)));
  }
  return major == 1 ? 10 : 12;
}

}  // namespace

std::size_t BytesOfType(std::string_view type) {
  constexpr std::array<std::pair<std::string_view, std::size_t>, 12> kTypes{{{"<f2", 2},
                                                                             {"<f4", 4},
                                                                             {"<f8", 8},
                                                                             {"|i1", 1},
                                                                             {"<i2", 2},
                                                                             {"<i4", 4},
                                                                             {"<i8", 8},
                                                                             {"|u1", 1},
                                                                             {"<u2", 2},
                                                                             {"<u4", 4},
                                                                             {"<u8", 8},
                                                                             {"|b1", 1}}};
  for (const auto& [name, bytes] : kTypes) {
    if (name == type) return bytes;
  }
  return 0;
}

std::optional<std::size_t> CountOfShape(const std::vector<std::size_t>& shape) {
  std::size_t count = 1;
  for (const std::size_t extent : shape) {
    if (extent > 0 && count > std::numeric_limits<std::size_t>::max() / extent) return {};
    count *= extent;
  }
  return count;
}

std::string FormatShape(const std::vector<std::size_t>& shape) {
  return fmt::format("({}{})", fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
}

std::size_t NpyHeaderLength(std::string_view preamble) {
  const std::size_t start = PreambleLength(preamble);
  if (preamble.size() < start) throw Error("is cut short in its .npy header");
  std::size_t length = 0;
  for (std::size_t i = start; i-- > 8;) length = length << 8 | Byte(preamble, i);
  return start + length;
}

NpyHeader ParseNpyHeader(std::string_view bytes) {
  if (bytes.size() != NpyHeaderLength(bytes)) throw Error("is cut short in its .npy header");
  return DictionaryParser(bytes.substr(PreambleLength(bytes))).Parse();
}

std::string FormatNpyHeader(const NpyHeader& header) {
  std::string text = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}",
                                 header.type, FormatShape(header.shape));
  constexpr std::size_t kPreamble = 10;
  text.append(63 - (kPreamble + text.size()) % 64, ' ');
  text += '\n';
  std::string bytes(kMagic);
  bytes += {1, 0, static_cast<char>(text.size() % 256), static_cast<char>(text.size() / 256)};
  return bytes + text;
}

}  // namespace physpring

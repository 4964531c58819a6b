// SPDX-License-Identifier: Apache-2.0
#include "splats/ply_header.h"

#include <fmt/format.h>

#include <sstream>
#include <utility>

#include "twin/error.h"
#include "twin/quote.h"

namespace physpring {
namespace {

constexpr std::size_t kLongestHeader = 1 << 16;  // bytes

std::size_t SizeOf(const std::string& type) {
  static const std::map<std::string, std::size_t> sizes = {
      {"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},  {"short", 2}, {"ushort", 2},
      {"int16", 2}, {"uint16", 2},  {"int", 4},    {"uint", 4},   {"int32", 4}, {"uint32", 4},
      {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
  const auto found = sizes.find(type);
  return found == sizes.end() ? 0 : found->second;
}

class Parser {
 public:
  Parser(std::string path, std::string_view bytes) : path_(std::move(path)), bytes_(bytes) {}

  PlyHeader Read() {
    if (Line() != "ply") FailPly(path_, "is no .ply file");
    for (std::string line = Line(); line != "end_header"; line = Line()) Take(line);
    if (!has_format_) FailPly(path_, "does not say its format");
    if (header_.count == 0) FailPly(path_, "has no element 'vertex', or an empty one");
    header_.start = next_;
    return header_;
  }

 private:
  std::string Line() {
    const std::size_t end = bytes_.substr(0, kLongestHeader).find('\n', next_);
    if (end == std::string_view::npos) FailPly(path_, "is no .ply file, or ends within its header");
    std::string line(bytes_.substr(next_, end - next_));
    next_ = end + 1;
    if (line.ends_with('\r')) line.pop_back();
    return line;
  }

  void Take(const std::string& line) {
    std::istringstream words(line);
    std::string first, second, third;
    words >> first >> second >> third;
    if (first == "format") {
      if (second != "binary_little_endian") {
        FailPly(path_, fmt::format("is {}, expected binary_little_endian", Quote(second)));
      }
      has_format_ = true;
    } else if (first == "element") {
      Element(second, third);
    } else if (first == "property") {
      Property(second, third);
    } else if (first != "comment" && first != "obj_info") {
      FailPly(path_, fmt::format("has {} in its header", Quote(line)));
    }
  }

  void Element(const std::string& name, const std::string& count) {
    if (name == "chunk" || name == "sh") {
      FailPly(path_, "is compressed; convert it to a plain .ply of Gaussians");
    }
    if (name != "vertex" && header_.count == 0) {
      FailPly(path_, fmt::format("begins with the element {}, expected 'vertex'", Quote(name)));
    }
    in_vertex_ = name == "vertex";
    if (!in_vertex_) return;  // behind what is read
    std::istringstream number(count);
    if (!(number >> header_.count) || header_.count < 1) {
      FailPly(path_, fmt::format("has {} splats, expected 1 or more", Quote(count)));
    }
    if (header_.count > kMostSplats) {
      FailPly(path_, fmt::format("has {} splats, expected at most {}", header_.count, kMostSplats));
    }
  }

  void Property(const std::string& type, const std::string& name) {
    if (!in_vertex_) return;
    const std::size_t size = SizeOf(type);
    if (size == 0) FailPly(path_, fmt::format("has a property of type {}", Quote(type)));
    if (name.starts_with("packed_")) {
      FailPly(path_, "is compressed; convert it to a plain .ply of Gaussians");
    }
    if (type == "float" || type == "float32") header_.floats.emplace(name, header_.stride);
    header_.stride += size;
  }

  std::string path_;
  std::string_view bytes_;
  std::size_t next_ = 0;  // where the next line begins
  bool has_format_ = false, in_vertex_ = false;
  PlyHeader header_;
};

}  // namespace

PlyHeader ReadPlyHeader(const std::string& path, std::string_view bytes) {
  return Parser(path, bytes).Read();
}

std::size_t FloatAt(const PlyHeader& header, const std::string& path, const std::string& name) {
  const auto found = header.floats.find(name);
  if (found != header.floats.end()) return found->second;
  FailPly(path,
          fmt::format("has no property {} of type float, so it is no file of splats", Quote(name)));
}

void FailPly(const std::string& path, const std::string& what) { throw Error(path + ": " + what); }

}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
// Meshes written as files, by the formats' own words.
#ifndef PHYSPRING_TESTS_SUPPORT_MESH_FILES_H_
#define PHYSPRING_TESTS_SUPPORT_MESH_FILES_H_

#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>

#include "exporter/triangle_mesh.h"

namespace physpring {

inline void WriteObj(const TriangleMesh& mesh, const std::string& path) {
  std::ofstream file(path);
  for (const auto& x : mesh.vertices.colwise()) {
    file << fmt::format("v {} {} {}\n", x[0], x[1], x[2]);
  }
  for (const auto& [a, b, c] : mesh.faces) file << fmt::format("f {} {} {}\n", a + 1, b + 1, c + 1);
}

inline void AppendWord(std::uint32_t word, std::string* bytes) {
  char raw[4];
  std::memcpy(raw, &word, 4);
  bytes->append(raw, 4);
}

// Binary glTF: a header, a chunk of JSON and a chunk of data (the specification's section 4). Each
// face has corners of its own.
inline void WriteGlb(const TriangleMesh& mesh, const std::string& path) {
  std::string data;
  Eigen::Vector3f low = Eigen::Vector3f::Constant(1e30F), high = -low;
  for (const auto& face : mesh.faces) {
    for (const int corner : face) {
      const Eigen::Vector3f x = mesh.vertices.col(corner).cast<float>();
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
      data.append(reinterpret_cast<const char*>(x.data()), 12);
    }
  }
  std::string json = fmt::format(
      R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],)"
      R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],)"
      R"("accessors":[{{"bufferView":0,"componentType":5126,"count":{},"type":"VEC3",)"
      R"("min":[{},{},{}],"max":[{},{},{}]}}],)"
      R"("bufferViews":[{{"buffer":0,"byteLength":{}}}],"buffers":[{{"byteLength":{}}}]}})",
      3 * mesh.faces.size(), low[0], low[1], low[2], high[0], high[1], high[2], data.size(),
      data.size());
  while (json.size() % 4 != 0) json += ' ';
  std::string bytes = "glTF";
  AppendWord(2, &bytes);
  AppendWord(static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + data.size()), &bytes);
  AppendWord(static_cast<std::uint32_t>(json.size()), &bytes);
  bytes += "JSON" + json;
  AppendWord(static_cast<std::uint32_t>(data.size()), &bytes);
  bytes += std::string("BIN\0", 4) + data;
  std::ofstream(path, std::ios::binary) << bytes;
}

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_MESH_FILES_H_

// SPDX-License-Identifier: Apache-2.0
#include "exporter/mesh_file.h"

#include <gtest/gtest.h>

#include <fstream>
#include <vector>

#include "tests/support/mesh_files.h"
#include "tests/support/temporary_folder.h"
#include "twin/atomic_file.h"
#include "twin/error.h"

namespace physpring {
namespace {

// One triangle with a corner in each axis, at 0.5, 1 and 2.
constexpr char kObj[] = "v 0.5 0 0\nv 0 1 0\nv 0 0 2\nf 1 2 3\n";
constexpr char kPly[] =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
    "z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0.5 0 0\n0 1 0\n0 0 2\n3 0 1 2\n";
constexpr char kStl[] =
    "solid t\nfacet normal 0 0 0\nouter loop\nvertex 0.5 0 0\nvertex 0 1 0\nvertex 0 0 2\n"
    "endloop\nendfacet\nendsolid t\n";

std::string Glb() {
  TriangleMesh triangle;
  triangle.vertices = Points{{0.5, 0, 0}, {0, 1, 0}, {0, 0, 2}};
  triangle.faces = {{0, 1, 2}};
  const TemporaryFolder folder;
  WriteGlb(triangle, folder.File("t.glb"));
  return ReadFile(folder.File("t.glb"));
}

class MeshFile : public testing::Test {
 protected:
  std::string Write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_.File(name), std::ios::binary) << content;
    return folder_.File(name);
  }
  std::string MessageOf(const std::string& path) const {
    try {
      ReadMesh(path);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  TemporaryFolder folder_;
};

TEST_F(MeshFile, HoldsTheTriangleInEachFormat) {
  for (const auto& [name, content] : {std::pair<std::string, std::string>{"t.obj", kObj},
                                      {"t.ply", kPly},
                                      {"t.stl", kStl},
                                      {"t.glb", Glb()}}) {
    const TriangleMesh mesh = ReadMesh(Write(name, content));
    ASSERT_EQ(mesh.vertices.cols(), 3) << name;
    ASSERT_EQ(mesh.faces.size(), 1u) << name;
    const Eigen::Vector3d first = mesh.vertices.col(mesh.faces[0][0]);
    EXPECT_EQ(mesh.vertices.rowwise().sum(), Eigen::Vector3d(0.5, 1, 2)) << name;
    EXPECT_EQ((first.array() > 0).count(), 1) << name;
  }
}

TEST_F(MeshFile, EqualVerticesAreJoined) {
  const TriangleMesh mesh = ReadMesh(Write("t.obj",
                                           "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n"
                                           "f 1 2 3\nf 4 6 5\n"));
  EXPECT_EQ(mesh.vertices.cols(), 4);
  EXPECT_EQ(mesh.faces.size(), 2u);
}

TEST_F(MeshFile, PolygonsBecomeTriangles) {
  const TriangleMesh mesh =
      ReadMesh(Write("t.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nl 1 3\n"));
  EXPECT_EQ(mesh.faces.size(), 2u);
}

TEST_F(MeshFile, WhatIsNoMeshIsRefused) {
  EXPECT_EQ(MessageOf(folder_.File("none.obj")), folder_.File("none.obj") + ": no such file");
  EXPECT_EQ(MessageOf(folder_.path()), folder_.path() + ": no such file");
  for (const auto& [name, content] : {std::pair<std::string, std::string>{"text.obj", "hello\n"},
                                      {"empty.ply", ""},
                                      {"cut.glb", Glb().substr(0, 60)},
                                      {"other.xyz", "hello\n"},
                                      {"points.obj", "v 0 0 0\nv 1 0 0\n"},
                                      {"nan.obj", "v nan 0 0\nv 0 1 0\nv 0 0 2\nf 1 2 3\n"}}) {
    const std::string message = MessageOf(Write(name, content));
    EXPECT_EQ(message.rfind(folder_.File(name) + ": ", 0), 0u) << name << ": " << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace physpring

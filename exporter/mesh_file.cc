// SPDX-License-Identifier: Apache-2.0
#include "exporter/mesh_file.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <filesystem>

#include "twin/error.h"

namespace physpring {
namespace {

constexpr unsigned kMostVertices = 200000;

// Positions alone decide which vertices are equal, and points and lines are dropped.
void Configure(Assimp::Importer* importer) {
  importer->SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS,
                               aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS |
                                   aiComponent_COLORS | aiComponent_TEXCOORDS |
                                   aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS);
  importer->SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                               aiPrimitiveType_POINT | aiPrimitiveType_LINE);
}

void Append(const aiMesh& part, TriangleMesh* mesh) {
  const Eigen::Index first = mesh->vertices.cols();
  mesh->vertices.conservativeResize(3, first + part.mNumVertices);
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D& vertex = part.mVertices[i];
    mesh->vertices.col(first + i) << vertex.x, vertex.y, vertex.z;
  }
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    if (face.mNumIndices != 3) continue;
    std::array<int, 3> corners{};
    for (int k = 0; k < 3; ++k) corners[k] = static_cast<int>(first + face.mIndices[k]);
    mesh->faces.push_back(corners);
  }
}

}  // namespace

TriangleMesh ReadMesh(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) throw Error(path + ": no such file");
  Assimp::Importer importer;
  Configure(&importer);
  const aiScene* scene = importer.ReadFile(
      path, aiProcess_Triangulate | aiProcess_RemoveComponent | aiProcess_JoinIdenticalVertices |
                aiProcess_PreTransformVertices | aiProcess_SortByPType);
  if (!scene) throw Error(fmt::format("{}: is not a mesh: {}", path, importer.GetErrorString()));
  unsigned vertices = 0;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) vertices += scene->mMeshes[i]->mNumVertices;
  if (vertices > kMostVertices) {
    throw Error(fmt::format("{}: has {} vertices, more than {}; reduce it first", path, vertices,
                            kMostVertices));
  }
  TriangleMesh mesh;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) Append(*scene->mMeshes[i], &mesh);
  if (mesh.faces.empty()) throw Error(path + ": has no triangles");
  if (!mesh.vertices.allFinite()) throw Error(path + ": has a vertex that is not finite");
  return mesh;
}

}  // namespace physpring

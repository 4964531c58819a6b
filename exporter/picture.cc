// SPDX-License-Identifier: Apache-2.0
#include "exporter/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "exporter/mesh_place.h"
#include "exporter/skin_weights.h"
#include "exporter/surface.h"
#include "twin/error.h"
#include "twin/hierarchy.h"

namespace physpring {
namespace {

const char* const kColour = "0.36 0.55 0.78 1";

// Single precision is all that MuJoCo keeps of a skin.
template <class Values>
std::string ShortNumbers(const Values& values) {
  std::string text;
  for (const auto value : values) fmt::format_to(std::back_inserter(text), "{:.6g} ", value);
  if (!text.empty()) text.pop_back();
  return text;
}

// A tendon along each way from an end or a joint to the next one.
void AddRod(const LevelPlan& plan, const Picture& picture, XmlElement* mujoco) {
  const Rod rod = RodOfNodes(plan.system().rod, plan.system().node_count());
  std::string name = plan.name + "_rod";
  int count = 0;
  for (const std::vector<int>& way : RodWays(rod)) {
    XmlElement* spatial =
        AddElement(Section(mujoco, "tendon"), "spatial",
                   {{"name", name}, {"width", Number(picture.radius)}, {"rgba", kColour}});
    for (const int node : way) AddElement(spatial, "site", {{"site", plan.Body(node)}});
    name = fmt::format("{}_rod{}", plan.name, ++count);
  }
}

void AddSkin(const LevelPlan& plan, const Picture& picture, XmlElement* mujoco) {
  const Points nodes = plan.system().position.leftCols(plan.system().node_count());
  std::vector<int> faces;
  for (const std::array<int, 3>& face : picture.mesh.faces) {
    faces.insert(faces.end(), face.begin(), face.end());
  }
  XmlElement* skin = AddElement(Section(mujoco, "deformable"), "skin",
                                {{"name", plan.name + "_skin"},
                                 {"rgba", kColour},
                                 {"inflate", Number(picture.radius)},
                                 {"vertex", ShortNumbers(picture.mesh.vertices.reshaped())},
                                 {"face", Numbers(faces)}});
  const auto carried = BindToNodes(picture.mesh.vertices, nodes);
  for (int node = 0; node < plan.system().node_count(); ++node) {
    if (carried[node].empty()) continue;
    std::vector<int> vertices;
    std::vector<double> weights;
    for (const SkinWeight& weight : carried[node]) {
      vertices.push_back(weight.vertex);
      weights.push_back(weight.weight);
    }
    AddElement(skin, "bone",
               {{"body", plan.Body(node)},
                {"bindpos", ShortNumbers(nodes.col(node))},
                {"bindquat", "1 0 0 0"},
                {"vertid", Numbers(vertices)},
                {"vertweight", ShortNumbers(weights)}});
  }
}

}  // namespace

Picture MakePicture(const Twin& twin, const std::string& mesh_file) {
  const SpringMassSystem& system = twin.levels[0].system;
  const Points nodes = system.position.leftCols(system.node_count());
  Picture picture;
  if (!mesh_file.empty()) {
    PlacedMesh placed = ReadMeshAt(mesh_file, nodes.leftCols(twin.points));
    picture.mesh = std::move(placed.mesh);
    picture.warnings = std::move(placed.warnings);
    return picture;
  }
  const double spacing = Spacing(nodes), contact_radius = system.contact_radius.mean();
  picture.rod = !twin.rod.empty();
  if (picture.rod) {
    picture.radius = std::clamp(contact_radius, 0.1 * spacing, 0.5 * spacing);
  } else if (IsSheet(nodes)) {
    picture.radius = std::clamp(contact_radius, 0.02 * spacing, 0.2 * spacing);
    picture.mesh = SheetSurface(nodes);
  } else {
    picture.mesh = ClosedSurface(nodes, std::clamp(contact_radius, 0.5 * spacing, spacing));
  }
  return picture;
}

void AddPicture(const LevelPlan& plan, const Picture& picture, XmlElement* mujoco) {
  if (picture.rod) {
    AddRod(plan, picture, mujoco);
  } else {
    AddSkin(plan, picture, mujoco);
  }
}

}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
#include "exporter/scene.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "exporter/xml.h"
#include "twin/cone_name.h"

namespace physpring {
namespace {

// Where the object is in the reference configuration.
struct Extent {
  Eigen::Vector3d up;      // against gravity, |up| = 1
  Eigen::Vector3d centre;  // m
  double size;             // m, diagonal of the bounding box
};

Extent MeasureExtent(const LevelPlan& plan) {
  const Eigen::Vector3d& gravity = plan.setting.gravity;
  const Points& position = plan.system().position;
  const Eigen::Vector3d low = position.rowwise().minCoeff(), high = position.rowwise().maxCoeff();
  Extent extent;
  extent.up =
      gravity.norm() > 0 ? Eigen::Vector3d(-gravity.normalized()) : Eigen::Vector3d::UnitZ();
  extent.centre = (low + high) / 2;
  extent.size = std::max((high - low).norm(), 1e-3);
  return extent;
}

// From in front, a little above.
void AddCamera(const Extent& extent, XmlElement* worldbody) {
  Eigen::Vector3d side = Eigen::Vector3d::UnitY().cross(extent.up);
  side = side.norm() > 1e-3 ? side.normalized() : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d front = side.cross(extent.up);
  const Eigen::Vector3d back = (0.9 * front + 0.45 * extent.up + 0.2 * side).normalized();
  const Eigen::Vector3d right = extent.up.cross(back).normalized();
  Eigen::VectorXd axes(6);
  axes << right, back.cross(right);
  AddElement(worldbody, "camera",
             {{"name", "view"},
              {"pos", Numbers(extent.centre + 1.3 * extent.size * back)},
              {"xyaxes", Numbers(axes)}});
}

void AddOptions(const LevelPlan& plan, const Extent& extent, XmlElement* mujoco) {
  XmlElement* option = AddElement(mujoco, "option",
                                  {{"timestep", Number(plan.timestep)},
                                   {"integrator", "Euler"},
                                   {"gravity", Numbers(plan.setting.gravity)}});
  if (plan.WantsEllipticCone()) option->SetAttribute("cone", kElliptic);
  AddElement(mujoco, "statistic",
             {{"center", Numbers(extent.centre)}, {"extent", Number(2 * extent.size)}});
  XmlElement* visual = AddElement(mujoco, "visual");
  AddElement(visual, "headlight", {{"diffuse", "0.5 0.5 0.5"}, {"ambient", "0.3 0.3 0.3"}});
  AddElement(visual, "quality", {{"shadowsize", "1024"}});
}

void AddFloorLook(XmlElement* mujoco) {
  XmlElement* asset = AddElement(mujoco, "asset");
  AddElement(asset, "texture",
             {{"name", "floor"},
              {"type", "2d"},
              {"builtin", "checker"},
              {"rgb1", "0.85 0.87 0.9"},
              {"rgb2", "0.78 0.8 0.84"},
              {"width", "128"},
              {"height", "128"}});
  AddElement(
      asset, "material",
      {{"name", "floor"}, {"texture", "floor"}, {"texuniform", "true"}, {"texrepeat", "10 10"}});
}

void AddSurroundings(const std::optional<Eigen::Vector4d>& ground, const Extent& extent,
                     XmlElement* mujoco) {
  XmlElement* worldbody = AddElement(mujoco, "worldbody");
  AddElement(worldbody, "light",
             {{"pos", Numbers(extent.centre + 3 * extent.size * extent.up)},
              {"dir", Numbers(-extent.up)},
              {"cutoff", "60"},
              {"exponent", "1"}});
  if (ground) {
    const Eigen::Vector3d normal = ground->head<3>();
    AddElement(worldbody, "geom",
               {{"name", "floor"},
                {"type", "plane"},
                {"size", "0 0 0.05"},
                {"pos", Numbers((*ground)[3] * normal)},
                {"zaxis", Numbers(normal)},
                {"material", "floor"}});
  }
  AddCamera(extent, worldbody);
}

void AddKeyframes(const LevelPlan& plan, XmlElement* mujoco) {
  XmlElement* keyframe = AddElement(mujoco, "keyframe");
  AddElement(keyframe, "key", {{"name", "home"}});
  // the object moves, its controllers do not
  std::string velocity;
  for (int i = 0; i < plan.system().node_count(); ++i) velocity += i == 0 ? "0.5 0 0" : " 0.5 0 0";
  AddElement(keyframe, "key", {{"name", "test"}, {"qvel", velocity}});
}

}  // namespace

std::optional<Eigen::Vector4d> GroundOf(const LevelPlan& plan) {
  const TrainedGround& ground = plan.twin->ground;
  if (ground.known) return ground.plane;
  const Eigen::Vector3d up = MeasureExtent(plan).up;
  const Eigen::VectorXd heights =
      (up.transpose() * plan.system().position.leftCols(plan.system().node_count())).transpose() -
      plan.system().contact_radius;
  Eigen::Vector4d plane;
  plane << up, std::min(0.0, heights.minCoeff());
  return plane;
}

std::string FormatScene(const LevelPlan& plan, const std::string& level_file) {
  tinyxml2::XMLDocument document;
  XmlElement* mujoco = document.NewElement("mujoco");
  document.InsertEndChild(mujoco);
  mujoco->SetAttribute("model", (plan.name + " scene").c_str());
  AddElement(mujoco, "include", {{"file", level_file}});
  const Extent extent = MeasureExtent(plan);
  AddOptions(plan, extent, mujoco);
  const std::optional<Eigen::Vector4d> ground = GroundOf(plan);
  if (ground) AddFloorLook(mujoco);
  AddSurroundings(ground, extent, mujoco);
  AddKeyframes(plan, mujoco);
  return Print(document);
}

}  // namespace physpring

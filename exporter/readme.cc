// SPDX-License-Identifier: Apache-2.0
#include "exporter/readme.h"

#include <fmt/format.h>

#include "exporter/scene.h"
#include "exporter/xml.h"
#include "twin/cone_name.h"
#include "twin/contact_words.h"
#include "twin/ground.h"

namespace physpring {
namespace {

std::string FormatTable(const std::vector<ExportedLevel>& levels) {
  std::string table =
      "| model | scene | nodes | springs | time step | largest stable step |\n"
      "|---|---|---|---|---|---|\n";
  for (const ExportedLevel& level : levels) {
    table += fmt::format("| `{}` | `{}` | {} | {} | {:.4g} ms | {} |\n", level.model, level.scene,
                         level.plan.system().node_count(), level.plan.system().spring_count(),
                         1e3 * level.plan.timestep, level.plan.LargestTimestep());
  }
  return table;
}

std::string DescribeSprings(const LevelPlan& plan) {
  switch (plan.springs) {
    case SpringKind::kPlugin:
      return fmt::format(
          "Springs and drag are the plugin `physpring.springs`, with sub-steps of at most {:.4g} "
          "ms "
          "(level {}) inside each step of MuJoCo: the plugin library must be loaded first (`import "
          "mujoco` does so where the package `physpring` is installed).",
          1e3 * plan.substep, plan.level);
    case SpringKind::kFlex:
      return "Springs are the edges of 1-D flexes, grouped by stiffness: an approximation of the "
             "twin.";
    case SpringKind::kTendon:
    case SpringKind::kAuto:  // a plan has no open choice
      break;
  }
  return "Each spring is a spatial tendon.";
}

std::string DescribeContact(const LevelPlan& plan) {
  const ContactCoefficients& contact = plan.system().contact;
  const std::string law = DescribeCoefficients(contact.surface);
  switch (plan.contact) {
    case ContactKind::kNone:
      return "Nodes touch nothing.";
    case ContactKind::kPlugin:
      return "Contact is the learned impulse law (" + law + "), by the physpring plugin.";
    default:
      return "Contact is MuJoCo's soft one, with the learned friction and a damping that bounces "
             "about as learned (" +
             law + "), and with the cone of the scene's `<option>`; the twin was trained with " +
             (contact.surface.cone == FrictionCone::kElliptic ? "`elliptic`"
                                                              : "`pyramidal`, the default") +
             ". The learned impulse law itself needs the plugin.";
  }
}

std::string DescribeDifferences(const std::vector<ExportedLevel>& levels) {
  std::string text;
  for (const ExportedLevel& level : levels) {
    for (const std::string& difference : level.plan.differences) {
      text += fmt::format("- `{}`: {}\n", level.model, difference);
    }
  }
  return text.empty() ? "" : "Where it differs from the trained twin:\n" + text + "\n";
}

// How grasps open and close.
std::string DescribeReleases(const LevelPlan& plan) {
  if (plan.twin->late.empty() || plan.springs != SpringKind::kPlugin) return "";
  return "`data.plugin_state` begins with a number for each controller: 0 holds, 1 lets go. Those "
         "that take hold late in the recording begin with 1. A controller that takes hold again "
         "holds the object as it is then.\n\n";
}

std::string DescribeControllers(const LevelPlan& plan) {
  if (plan.system().controllers == 0) return "";
  if (plan.controllers == ControllerKind::kMocap) {
    return fmt::format(
        "The object is held by mocap bodies, `{}` ...: set `data.mocap_pos` before each step.\n\n",
        plan.Body(plan.system().node_count()));
  }
  return fmt::format(
      "The object is held by bodies on slide joints, `{0}` ..., because the twin's dashpots feel "
      "the velocity of what holds it, and mocap bodies have none. Actuators `{0}_x`, `_y`, `_z` "
      "... take them to `data.ctrl`, the displacement in metres, within one time step of "
      "{1:.4g} ms.\n\n",
      plan.Body(plan.system().node_count()), 1e3 * plan.timestep);
}

std::string DescribeFloor(const LevelPlan& plan) {
  const std::optional<Eigen::Vector4d> ground = GroundOf(plan);
  if (!ground) {
    return "The twin was trained without a ground, so the scenes have none and a free object "
           "falls.";
  }
  const std::string plane = DescribeGround(ground);
  if (plan.twin->ground.known) {
    return "The floor of the scenes, " + plane + ", is the ground that the twin was trained with.";
  }
  return "The twin's file does not say what ground it was trained with; the floor of the scenes, " +
         plane + ", is a guess.";
}

std::string ConeAttribute(const LevelPlan& plan) {
  return plan.WantsEllipticCone() ? fmt::format(" cone=\"{}\"", kElliptic) : "";
}

// Models of tendons and flexes use what MuJoCo has had since 3.6; attributes of tendons that stand
// for effects are newer.
std::string DescribeVersion(const std::vector<ExportedLevel>& levels) {
  bool plugin = false, effects = false;
  for (const ExportedLevel& level : levels) {
    plugin = plugin || level.plan.NeedsPlugin();
    for (const EffectMjcf& effect : level.plan.effects) effects = effects || !effect.tendon.empty();
  }
  if (plugin) return "Requires MuJoCo 4.0 and PhySPRING's plugin library. MJX ignores plugins.";
  return effects ? "Requires MuJoCo 4.0 or later." : "Requires MuJoCo 3.6 or later.";
}

// The plugin's sub-steps are its own.
std::string TimestepLimit(const LevelPlan& plan) {
  return plan.springs == SpringKind::kPlugin ? "" : " and a time step below the largest stable one";
}

}  // namespace

std::string FormatReadme(const std::vector<ExportedLevel>& levels, const std::string& command) {
  const LevelPlan& plan = levels[0].plan;
  return fmt::format(R"(# {0}

A deformable object as spring-mass systems, learned from {1} and exported by PhySPRING {2}:

```
{3}
```

{14}

{4}
```python
import mujoco
model = mujoco.MjModel.from_xml_path("scene.xml")
```

{5} {6}

{13}

{7}{9}In a scene of your own, with the Euler integrator{12}:

```xml
<option timestep="{10}" integrator="Euler"{11}/>
<asset>
  <model name="{0}" file="{8}"/>
</asset>
<worldbody>
  <attach model="{0}" prefix="a_"/>
</worldbody>
```

Node `i` is the body and the site `{0}_i`; `qpos` is its displacement from the reference configuration.
)",
                     plan.name, plan.twin->trained_on.empty() ? "a recording" : "recordings",
                     PHYSPRING_VERSION, command, FormatTable(levels), DescribeSprings(plan),
                     DescribeContact(plan), DescribeControllers(plan) + DescribeReleases(plan),
                     levels[0].model, DescribeDifferences(levels), Number(plan.timestep),
                     ConeAttribute(plan), TimestepLimit(plan), DescribeFloor(plan),
                     DescribeVersion(levels));
}

}  // namespace physpring

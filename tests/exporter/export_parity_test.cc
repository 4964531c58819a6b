// SPDX-License-Identifier: Apache-2.0
// The trainer's simulator against MuJoCo on what `physpring export` writes: the same trajectory, to
// rounding, 2,000 sub-steps long and free of contacts.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/support/exported_folder.h"
#include "tests/support/random_system.h"
#include "tests/support/small_twin.h"
#include "twin/simulator.h"

namespace physpring {
namespace {

constexpr int kFrames = 20;
constexpr int kSubsteps = 100;  // a frame

// The level in a frame that is turned and moved, with another body before it.
std::string TurnedScene(const LevelPlan& plan, const Eigen::Quaterniond& turn,
                        const Eigen::Vector3d& place) {
  const Eigen::Vector3d& gravity = plan.twin->gravity;
  return fmt::format(R"(
    <mujoco>
      <option timestep="{}" gravity="{} {} {}"/>
      <asset><model name="twin" file="level{}.xml"/></asset>
      <worldbody>
        <body pos="0 0 5"><freejoint/><geom size="0.1"/></body>
        <frame quat="{} {} {} {}" pos="{} {} {}"><attach model="twin" prefix="a_"/></frame>
      </worldbody>
    </mujoco>)",
                     plan.timestep, gravity[0], gravity[1], gravity[2], plan.level, turn.w(),
                     turn.x(), turn.y(), turn.z(), place[0], place[1], place[2]);
}

// The exported level in MuJoCo, in the coordinates of the twin.
class MujocoTwin {
 public:
  MujocoTwin(const LevelPlan& plan, const ModelPtr& model, const Eigen::Quaterniond& turn,
             const Eigen::Vector3d& place)
      : plan_(plan), model_(*model), data_(MakeData(*model)), turn_(turn), place_(place) {
    first_ = mj_name2id(&model_, mjOBJ_BODY, ("a_" + plan.Body(0)).c_str());
    const int held = plan.system().node_count();
    controller_ = mj_name2id(&model_, mjOBJ_BODY, ("a_" + plan.Body(held)).c_str());
  }

  void SetState(const Points& position, const Points& velocity) {
    const Points displacement = position - plan_.system().position.leftCols(position.cols());
    Eigen::Map<Points>(data_->qpos + Qpos(first_), 3, position.cols()) = displacement;
    Eigen::Map<Points>(data_->qvel + Dof(first_), 3, position.cols()) = velocity;
  }

  // One step, with the controllers where they are at its end, coming from `before`.
  void Step(const Points& before, const Points& after) {
    const Eigen::Index count = after.cols();
    if (plan_.controllers == ControllerKind::kMocap) {
      const Points world = (turn_.matrix() * after).colwise() + place_;
      Eigen::Map<Points>(data_->mocap_pos, 3, count) = world;
    } else {
      const Points rest = plan_.system().position.rightCols(count);
      Eigen::Map<Points>(data_->qpos + Qpos(controller_), 3, count) = after - rest;
      Eigen::Map<Points>(data_->qvel + Dof(controller_), 3, count) =
          (after - before) / plan_.timestep;
    }
    physpring::Step(model_, data_.get());
  }

  Points Positions() const {
    const int nodes = plan_.system().node_count();
    return plan_.system().position.leftCols(nodes) +
           Eigen::Map<const Points>(data_->qpos + Qpos(first_), 3, nodes);
  }

 private:
  int Dof(int body) const { return model_.body_dofadr[body]; }
  int Qpos(int body) const { return model_.jnt_qposadr[model_.body_jntadr[body]]; }

  const LevelPlan& plan_;
  const mjModel& model_;
  DataPtr data_;
  Eigen::Quaterniond turn_;
  Eigen::Vector3d place_;
  int first_, controller_;
};

struct Distance {
  double nodes = 0;      // m, the greatest between simulator and MuJoCo after any frame
  double travelled = 0;  // m, the greatest that a node has moved
};

// From random positions and velocities, dragged along by the controllers on random ways.
Distance Compare(const Twin& twin, const ExportOptions& options, const Eigen::Quaterniond& turn,
                 const Eigen::Vector3d& place) {
  const ExportedFolder folder(twin, options);
  const LevelPlan& plan = folder.result.levels[0].plan;
  const SpringMassSystem& system = plan.system();
  const ModelPtr model = folder.LoadText(TurnedScene(plan, turn, place));
  MujocoTwin mujoco(plan, model, turn, place);

  Environment environment;
  environment.gravity = turn.matrix().transpose() * twin.gravity;
  const Simulator<double> simulator(
      system, environment, {kSubsteps * plan.substep, kSubsteps, twin.controller_velocity});
  Simulator<double>::Workspace workspace(simulator);
  Random random(7);
  const int nodes = system.node_count();
  const Points start = system.position.leftCols(nodes) + random.Box(nodes, 0.002);
  const Points velocity = random.Box(nodes, 0.5);
  NodeStates<double> state = simulator.MakeState(start, velocity);
  mujoco.SetState(start, velocity);

  Distance distance;
  Points hands = system.position.rightCols(system.controllers), before = hands;
  for (int frame = 0; frame < kFrames; ++frame) {
    const Points next = hands + random.Box(system.controllers, 0.02);
    simulator.AdvanceFrame({hands, next, {}}, &state, &workspace);
    for (int substep = 1; substep <= kSubsteps; ++substep) {
      const Points after = hands + (next - hands) * (static_cast<double>(substep) / kSubsteps);
      mujoco.Step(before, after);
      before = after;
    }
    hands = next;
    const Points position = simulator.Positions(state);
    distance.nodes =
        std::max(distance.nodes, (position - mujoco.Positions()).cwiseAbs().maxCoeff());
    distance.travelled =
        std::max(distance.travelled, (position - start).colwise().norm().maxCoeff());
  }
  return distance;
}

const Eigen::Quaterniond kNoTurn = Eigen::Quaterniond::Identity();
const Eigen::Quaterniond kTurn(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, -2, 3).normalized()));

ExportOptions ContactFree(ControllerKind controllers) {
  ExportOptions options;
  options.level = 0;
  options.controllers = controllers;
  options.contact = ContactKind::kNone;
  return options;
}

// measured everywhere: below 1e-14 m, rounding alone
void ExpectParity(const Distance& distance) {
  EXPECT_GT(distance.travelled, 0.05);
  EXPECT_LT(distance.nodes, 1e-9);
}

TEST(ExportParity, MocapControllersWithoutVelocity) {
  Twin twin = SmallTwin(1);
  twin.controller_velocity = false;
  ExpectParity(Compare(twin, ContactFree(ControllerKind::kMocap), kNoTurn, {0, 0, 0}));
}

TEST(ExportParity, SlideControllersWithVelocity) {
  ExpectParity(Compare(SmallTwin(1), ContactFree(ControllerKind::kAuto), kNoTurn, {0, 0, 0}));
}

TEST(ExportParity, MocapControllersHaveNoVelocity) {
  const Distance distance =
      Compare(SmallTwin(1), ContactFree(ControllerKind::kMocap), kNoTurn, {0, 0, 0});
  EXPECT_GT(distance.nodes, 1e-6);
}

TEST(ExportParity, UnderATurnedParent) {
  Twin twin = SmallTwin(1);
  ExpectParity(Compare(twin, ContactFree(ControllerKind::kAuto), kTurn, {0.3, -0.2, 1}));
  twin.controller_velocity = false;
  ExpectParity(Compare(twin, ContactFree(ControllerKind::kAuto), kTurn, {0.3, -0.2, 1}));
}

TEST(ExportParity, OfACoarseLevel) {
  ExportOptions options = ContactFree(ControllerKind::kAuto);
  options.level = 2;
  ExpectParity(Compare(SmallTwin(3), options, kNoTurn, {0, 0, 0}));
}

TEST(ExportParity, FlexesWithoutRounding) {
  // all stiffnesses and dashpots are the same, all rest lengths those of the reference
  ExportOptions options = ContactFree(ControllerKind::kAuto);
  options.springs = SpringKind::kFlex;
  ExpectParity(Compare(SmallTwin(1), options, kTurn, {0.3, -0.2, 1}));
}

}  // namespace
}  // namespace physpring

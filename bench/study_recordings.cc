// SPDX-License-Identifier: Apache-2.0
#include "bench/study_recordings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rollout/effects/registry.h"
#include "rollout/scene.h"
#include "rollout/undeclared_effects.h"
#include "tests/support/random_system.h"

namespace physpring {
namespace {

constexpr int kFrames = 75, kSteps = 100;  // steps of MuJoCo a frame
// An effect's size grows by this factor, up to the largest, until it moves the body so far, in the
// mean: what moves it less is lost in the noise.
constexpr double kGrowth = 1.5, kLargestSize = 4, kLeastMoved = 4e-3;  // m
constexpr double kFps = 50, kTimestep = 1 / (kFps * kSteps);
constexpr double kMass = 0.03;         // kg, of the body
constexpr double kYoung = 1;           // N: stiffness times length of the shortest springs
constexpr double kDrag = 1.5;          // 1/s
constexpr double kNodeRadius = 0.012;  // m, in the air
// kg/m: density of air, the blunt coefficient of MuJoCo's ellipsoids, cross-section
constexpr double kNodeDrag = 1.2 * 0.5 * std::numbers::pi * kNodeRadius * kNodeRadius;

// A regular grid of points, some held; springs reach `reach` spacings.
struct Grid {
  int across, down, deep;
  double spacing, reach;
};

Grid GridOf(StudyBody body) {
  switch (body) {
    case StudyBody::kRope:
      return {8, 2, 2, 0.02, 1.8};
    case StudyBody::kSheet:
      return {5, 4, 1, 0.03, 2.1};
    case StudyBody::kBlock:
      return {4, 3, 3, 0.025, 1.5};
  }
  return {};
}

struct Lattice {
  Points nodes, held;                       // 3 x ., m
  std::vector<std::array<int, 2>> springs;  // held ones are counted after the nodes
  std::vector<double> length;
};

Lattice MakeLattice(StudyBody body) {
  const Grid grid = GridOf(body);
  std::vector<Eigen::Vector3d> nodes, held;
  for (int i = 0; i < grid.across; ++i) {
    for (int j = 0; j < grid.down; ++j) {
      for (int k = 0; k < grid.deep; ++k) {
        const Eigen::Vector3d place(i * grid.spacing, j * grid.spacing, 0.6 + k * grid.spacing);
        const bool corner = j == 0 && (i == 0 || i == grid.across - 1);
        const bool is_held = body == StudyBody::kSheet ? corner : i == 0;
        (is_held ? held : nodes).push_back(place);
      }
    }
  }
  Lattice lattice;
  lattice.nodes.resize(3, static_cast<Eigen::Index>(nodes.size()));
  lattice.held.resize(3, static_cast<Eigen::Index>(held.size()));
  for (std::size_t i = 0; i < nodes.size(); ++i) lattice.nodes.col(i) = nodes[i];
  for (std::size_t i = 0; i < held.size(); ++i) lattice.held.col(i) = held[i];
  nodes.insert(nodes.end(), held.begin(), held.end());
  for (int i = 0; i < static_cast<int>(lattice.nodes.cols()); ++i) {
    for (int j = i + 1; j < static_cast<int>(nodes.size()); ++j) {
      const double length = (nodes[i] - nodes[j]).norm();
      if (length > grid.reach * grid.spacing) continue;
      lattice.springs.push_back({i, j});
      lattice.length.push_back(length);
    }
  }
  return lattice;
}

// The damping of a slide joint that makes a body of this mass slow down at the rate kDrag.
double Damping(double mass) { return mass * std::expm1(kTimestep * kDrag) / kTimestep; }

std::string Place(const Eigen::Vector3d& place) {
  return fmt::format("{} {} {}", place[0], place[1], place[2]);
}

std::string Mjcf(const Lattice& lattice) {
  std::string bodies, tendons;
  const auto nodes = static_cast<int>(lattice.nodes.cols());
  for (int i = 0; i < nodes; ++i) {
    std::string joints;
    for (const char* axis : {"1 0 0", "0 1 0", "0 0 1"}) {
      joints += fmt::format(R"(<joint type="slide" axis="{}"/>)", axis);
    }
    bodies += fmt::format(
        R"(<body pos="{}">{}<geom type="sphere" size="{}" mass="{}" fluidshape="ellipsoid" )"
        R"(fluidcoef="0.5 0 0 0 0" contype="0" conaffinity="0"/><site name="{}"/></body>)",
        Place(lattice.nodes.col(i)), joints, kNodeRadius, kMass / nodes, i);
  }
  for (int i = 0; i < lattice.held.cols(); ++i) {
    bodies += fmt::format(R"(<body mocap="true" pos="{}"><site name="{}"/></body>)",
                          Place(lattice.held.col(i)), nodes + i);
  }
  for (std::size_t e = 0; e < lattice.springs.size(); ++e) {
    const double length = lattice.length[e], stiffness = 2 * kYoung / length;
    tendons += fmt::format(
        R"(<spatial stiffness="{}" damping="{}" springlength="{}"><site site="{}"/>)"
        R"(<site site="{}"/></spatial>)",
        stiffness, 5e-4 * stiffness, length, lattice.springs[e][0], lattice.springs[e][1]);
  }
  return fmt::format(
      R"(<mujoco><option integrator="Euler" timestep="{}"><flag contact="disable"/></option>)"
      R"(<worldbody>{}</worldbody><tendon>{}</tendon></mujoco>)",
      kTimestep, bodies, tendons);
}

// A random place and direction; `size` is about 1.
EffectTrial DrawTrial(double size, const Lattice& lattice, Random* random) {
  const Eigen::Index nodes = lattice.nodes.cols();
  const Eigen::Vector3d node = lattice.nodes.col(
      static_cast<Eigen::Index>((*random)(0.5, 1) * static_cast<double>(nodes - 1)));
  const double angle = (*random)(0, 2 * std::numbers::pi);
  return {.size = size,
          .nodes = static_cast<int>(nodes),
          .mass = kMass,
          .drag = static_cast<double>(nodes) * kNodeDrag,
          .node = node,
          .sideways = {std::cos(angle), std::sin(angle), 0},
          .beside = {0.1, 0.05, 0.5}};
}

SceneEffects MakeEffect(const std::string& name, double size, const Lattice& lattice,
                        Random* random) {
  const EffectTrial trial = DrawTrial(size, lattice, random);
  const SceneEffect* effect = FindSceneEffect(name);
  SceneEffects effects;
  if (!effect) return effects;
  const EffectAmounts amounts = effect->Trial(trial);
  for (const auto& [key, value] : amounts.all()) {
    effects[fmt::format("{}.{}", name, key)] = value;
  }
  return effects;
}

// Where the hands are: at the frames on sums of sines from rest, between them on straight lines, as
// a recording tells it.
class Hands {
 public:
  explicit Hands(Random* random) {
    for (int axis = 0; axis < 3; ++axis) {
      amplitude_[axis] = (*random)(0.02, 0.04);
      rate_[axis] = (*random)(4, 8);
      phase_[axis] = (*random)(0, 6);
    }
  }
  Eigen::Vector3d At(double time) const {
    const double frame = std::floor(time * kFps + 1e-9), way = time * kFps - frame;
    return (1 - way) * Curve(frame / kFps) + way * Curve((frame + 1) / kFps);
  }

 private:
  Eigen::Vector3d Curve(double time) const {
    Eigen::Vector3d moved;
    for (int axis = 0; axis < 3; ++axis) {
      moved[axis] = amplitude_[axis] *
                    (std::sin(rate_[axis] * time + phase_[axis]) - std::sin(phase_[axis])) *
                    std::min(1.0, 4 * time);
    }
    return time > 0 ? moved : Eigen::Vector3d(Eigen::Vector3d::Zero());
  }

  Eigen::Vector3d amplitude_, rate_, phase_;
};

// On all bodies, N.
Eigen::Vector3d NetForce(const mjModel& model, const mjData& data) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int body = 1; body < model.nbody; ++body) {
    sum += Eigen::Map<const Eigen::Vector3d>(data.xfrc_applied + 6 * body);
  }
  return sum;
}

// `outside`: the sum over the nodes of what acts on them from outside, N, 3 x steps of a frame.
Recording Record(const Lattice& lattice, const SceneEffects& given, const Hands& hands,
                 Points* outside = nullptr) {
  const std::string mjcf = Mjcf(lattice);
  const ModelPtr plain = CompileScene(mjcf, "study", [](mjSpec*) {});
  const SoftPoints soft = FindSoftPoints(*plain, "study");
  const UndeclaredEffects effects(given, *plain, soft, "study");
  const ModelPtr model = CompileScene(mjcf, "study", [&](mjSpec* spec) { effects.Edit(spec); });
  effects.Change(model.get());
  for (int dof = 0; dof < model->nv; ++dof) {
    model->dof_damping[dof] = Damping(model->body_mass[model->dof_bodyid[dof]]);
  }
  const DataPtr data = MakeData(*model);
  Recording recording;
  recording.fps = kFps;
  recording.mass = kMass;
  recording.train_frames = kFrames;
  recording.start.resize(3, lattice.nodes.cols() + lattice.held.cols());
  recording.start << lattice.nodes, lattice.held;
  recording.rest = recording.start;
  recording.interior.resize(3, 0);
  recording.velocity = Points::Zero(3, lattice.nodes.cols());
  if (outside != nullptr) *outside = Points::Zero(3, kFrames - 1);
  for (int frame = 0; frame < kFrames; ++frame) {
    recording.points.emplace_back(lattice.nodes +
                                  Eigen::Map<const Points>(data->qpos, 3, lattice.nodes.cols()));
    recording.controllers.emplace_back(lattice.held.colwise() + hands.At(frame / kFps));
    for (int step = 0; step < kSteps; ++step) {
      const double time = frame / kFps + step * kTimestep;
      effects.Drive(time, model.get(), data.get());
      Eigen::Map<Points>(data->mocap_pos, 3, lattice.held.cols()) =
          lattice.held.colwise() + hands.At(time + kTimestep - effects.latency());
      if (outside != nullptr && frame < kFrames - 1) {
        outside->col(frame) += NetForce(*model, *data) / kSteps;
      }
      Step(*model, data.get());
    }
  }
  return recording;
}

double MeanDistance(const Recording& p, const Recording& q) {
  double sum = 0;
  for (std::size_t t = 1; t < p.points.size(); ++t) {
    sum += (p.points[t] - q.points[t]).colwise().norm().mean();
  }
  return sum / static_cast<double>(p.points.size() - 1);
}

void AddNoise(double noise, Random* random, Recording* recording) {
  for (std::size_t t = 1; t < recording->points.size(); ++t) {
    for (double& value : recording->points[t].reshaped()) {
      value += noise * std::sqrt(-2 * std::log(1 - (*random)(0, 1))) *
               std::cos(2 * std::numbers::pi * (*random)(0, 1));
    }
  }
}

}  // namespace

const std::vector<std::string>& StudyEffects() {
  static const std::vector<std::string> kEffects = [] {
    std::vector<std::string> names;
    for (const SceneEffect* effect : AllSceneEffects()) {
      if (!effect->Trial({}).all().empty()) names.push_back(effect->name());
    }
    return names;
  }();
  return kEffects;
}

MadeRecordings MakeWithEffect(StudyBody body, const std::string& effect, double noise,
                              std::uint64_t seed) {
  Random random(seed);
  const Lattice lattice = MakeLattice(body);
  double size = random(0.8, 1.6);
  const Random place = random;
  DrawTrial(1, lattice, &random);
  const Hands first(&random), second(&random);
  const Recording without = Record(lattice, {}, first);
  SceneEffects effects;
  MadeRecordings made;
  for (;; size *= kGrowth) {
    Random same = place;
    effects = MakeEffect(effect, size, lattice, &same);
    made.fit = Record(lattice, effects, first, &made.outside);
    made.displacement = MeanDistance(made.fit, without);
    if (effect == "none" || made.displacement >= kLeastMoved) break;
    if (kGrowth * size > kLargestSize) break;
  }
  made.other = Record(lattice, effects, second);
  made.fit.name = effect + " fit", made.other.name = effect + " other";
  made.fit.hash = "fit", made.other.hash = "other";
  AddNoise(noise, &random, &made.fit);
  AddNoise(noise, &random, &made.other);
  return made;
}

}  // namespace physpring

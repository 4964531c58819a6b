// SPDX-License-Identifier: Apache-2.0
#include "bench/undeclared_effects.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rollout/mujoco_log.h"
#include "rollout/scene.h"
#include "tests/support/random_system.h"
#include "twin/error.h"

namespace physpring {
namespace {

constexpr int kFrames = 75, kSteps = 40;  // steps of MuJoCo a frame
constexpr double kFps = 50, kTimestep = 1 / (kFps * kSteps);
constexpr double kMass = 0.03;         // kg, of the body
constexpr double kYoung = 1;           // N: stiffness times length of the shortest springs
constexpr double kDrag = 1.5;          // 1/s
constexpr double kNodeRadius = 0.012;  // m, in the air

// A regular grid of points, some held; springs reach `reach` spacings.
struct Grid {
  int across, down, deep;
  double spacing, reach;
};

Grid GridOf(Body body) {
  switch (body) {
    case Body::kRope:
      return {8, 2, 2, 0.02, 1.8};
    case Body::kSheet:
      return {5, 4, 1, 0.03, 2.1};
    case Body::kBlock:
      return {4, 3, 3, 0.025, 1.5};
  }
  return {};
}

struct Lattice {
  Points nodes, held;                       // 3 x ., m
  std::vector<std::array<int, 2>> springs;  // held ones are counted after the nodes
  std::vector<double> length;
};

Lattice MakeLattice(Body body) {
  const Grid grid = GridOf(body);
  std::vector<Eigen::Vector3d> nodes, held;
  for (int i = 0; i < grid.across; ++i) {
    for (int j = 0; j < grid.down; ++j) {
      for (int k = 0; k < grid.deep; ++k) {
        const Eigen::Vector3d place(i * grid.spacing, j * grid.spacing, 0.6 + k * grid.spacing);
        const bool corner = j == 0 && (i == 0 || i == grid.across - 1);
        const bool is_held = body == Body::kSheet ? corner : i == 0;
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

// The world with the effect; `size` is about 1.
class World {
 public:
  World(const Lattice& lattice, std::string effect, double size, Random* random)
      : lattice_(lattice), effect_(std::move(effect)), size_(size) {
    node_ = static_cast<int>((*random)(0.5, 1) * static_cast<double>(lattice.nodes.cols() - 1));
    angle_ = (*random)(0, 2 * std::numbers::pi);
  }

  std::string Mjcf() const {
    std::string bodies, tendons;
    const auto nodes = static_cast<int>(lattice_.nodes.cols());
    const double mass = kMass / nodes;
    for (int i = 0; i < nodes; ++i) {
      const double own = mass + (Is("mass_distribution") && i == node_ ? 0.5 * size_ * kMass : 0);
      const double damping = own * std::expm1(kTimestep * kDrag) / kTimestep;
      std::string joints;
      for (const char* axis : {"1 0 0", "0 1 0", "0 0 1"}) {
        joints += fmt::format(R"(<joint type="slide" axis="{}" damping="{}"/>)", axis, damping);
      }
      bodies += fmt::format(
          R"(<body pos="{} {} {}">{}<geom type="sphere" size="{}" mass="{}" fluidshape="ellipsoid" )"
          R"(fluidcoef="0.5 0 0 0 0" contype="0" conaffinity="0"/><site name="{}"/></body>)",
          lattice_.nodes(0, i), lattice_.nodes(1, i), lattice_.nodes(2, i), joints, kNodeRadius,
          own, i);
    }
    for (int i = 0; i < lattice_.held.cols(); ++i) {
      bodies +=
          fmt::format(R"(<body mocap="true" pos="{} {} {}"><site name="{}"/></body>)",
                      lattice_.held(0, i), lattice_.held(1, i), lattice_.held(2, i), nodes + i);
    }
    for (std::size_t e = 0; e < lattice_.springs.size(); ++e) tendons += Tendon(e);
    if (Is("tether")) {
      const Eigen::Vector3d anchor = lattice_.nodes.col(node_) + 0.1 * Sideways();
      bodies +=
          fmt::format(R"(<site name="anchor" pos="{} {} {}"/>)", anchor[0], anchor[1], anchor[2]);
      tendons += fmt::format(
          R"(<spatial stiffness="{}" springlength="0"><site site="{}"/><site site="anchor"/></spatial>)",
          2 * size_, node_);
    }
    Eigen::Vector3d gravity(0, 0, -9.81);
    if (Is("gravity_direction")) {
      const double tilt = 0.12 * size_;
      gravity = 9.81 * (std::sin(tilt) * Sideways() - std::cos(tilt) * Eigen::Vector3d::UnitZ());
    }
    std::string air;
    if (Is("air_drag")) {
      const Eigen::Vector3d wind = 3 * size_ * Sideways();
      air = fmt::format(R"(density="1.2" wind="{} {} {}")", wind[0], wind[1], wind[2]);
    }
    return fmt::format(
        R"(<mujoco><option integrator="Euler" timestep="{}" gravity="{} {} {}" {}>)"
        R"(<flag contact="disable"/></option><worldbody>{}</worldbody><tendon>{}</tendon></mujoco>)",
        kTimestep, gravity[0], gravity[1], gravity[2], air, bodies, tendons);
  }

  // What changes in time, before the step that begins at `time`.
  void Drive(double time, mjModel* model, mjData* data) const {
    if (Is("stiffness_drift")) {
      for (int e = 0; e < model->ntendon; ++e) {
        model->tendon_stiffness[e] =
            Stiffness(static_cast<std::size_t>(e)) * std::max(0.2, 1 - 0.5 * size_ * time);
      }
    }
    for (int i = 0; i < lattice_.nodes.cols(); ++i) {
      Eigen::Map<Eigen::Vector3d> force(data->qfrc_applied + 3 * i);
      const double share = 1 / static_cast<double>(lattice_.nodes.cols());
      if (Is("uniform_force")) {
        force = 0.08 * size_ * share * std::sin(2 * std::numbers::pi * time / 0.9) * Sideways();
      }
      if (Is("moving_attraction")) {
        const Eigen::Vector3d place =
            lattice_.nodes.col(i) + Eigen::Map<const Eigen::Vector3d>(data->qpos + 3 * i);
        const Eigen::Vector3d magnet(0.1 + 0.12 * std::sin(8 * time),
                                     0.05 + 0.12 * std::cos(8 * time), 0.5);
        const Eigen::Vector3d away = magnet - place;
        force = 4e-5 * size_ * away / std::pow(away.squaredNorm() + 9e-4, 1.5);
      }
    }
  }

  double latency() const { return Is("control_latency") ? 0.06 * size_ : 0; }

 private:
  bool Is(const char* effect) const { return effect_ == effect; }
  Eigen::Vector3d Sideways() const { return {std::cos(angle_), std::sin(angle_), 0}; }
  double Stiffness(std::size_t e) const { return 2 * kYoung / lattice_.length[e]; }

  std::string Tendon(std::size_t e) const {
    double length = lattice_.length[e];
    std::string more, stiffness = fmt::format("{}", Stiffness(e));
    if (Is("rest_length")) {
      const double middle =
          lattice_.nodes(0, lattice_.springs[e][0]) / lattice_.nodes.row(0).maxCoeff();
      length *= 1 + 0.08 * size_ * (middle - 0.3);
    }
    if (Is("stiffening")) {
      stiffness += fmt::format(" 0 {}", 60 * size_ * Stiffness(e) / (length * length));
    }
    if (Is("yield")) more = fmt::format(R"( springyield="{}")", 0.03 * length / size_);
    if (Is("dry_friction")) {
      more = fmt::format(R"( frictionloss="{}")", 0.01 * size_ * Stiffness(e) * length);
    }
    const std::string spring =
        Is("tension_only") ? fmt::format("0 {}", length) : fmt::format("{}", length);
    return fmt::format(
        R"(<spatial stiffness="{}" damping="{}" springlength="{}"{}><site site="{}"/>)"
        R"(<site site="{}"/></spatial>)",
        stiffness, 5e-4 * Stiffness(e), spring, more, lattice_.springs[e][0],
        lattice_.springs[e][1]);
  }

  const Lattice& lattice_;
  std::string effect_;
  double size_;
  int node_;
  double angle_;
};

// Where the hands are: sums of sines from rest.
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
    Eigen::Vector3d moved;
    for (int axis = 0; axis < 3; ++axis) {
      moved[axis] = amplitude_[axis] *
                    (std::sin(rate_[axis] * time + phase_[axis]) - std::sin(phase_[axis])) *
                    std::min(1.0, 4 * time);
    }
    return time > 0 ? moved : Eigen::Vector3d(Eigen::Vector3d::Zero());
  }

 private:
  Eigen::Vector3d amplitude_, rate_, phase_;
};

ModelPtr Compile(const std::string& mjcf) {
  char message[1024] = "";
  mjSpec* spec = mj_parseXMLString(mjcf.c_str(), nullptr, message, sizeof(message));
  if (!spec) throw Error(message);
  mjModel* model = nullptr;
  const std::vector<std::string> warnings = CatchMujoco([&] { model = mj_compile(spec, nullptr); });
  const std::string error = model ? "" : mjs_getError(spec);
  mj_deleteSpec(spec);
  ModelPtr owner(model);
  if (!model) throw Error(error);
  if (!warnings.empty()) throw Error(warnings.front());
  return owner;
}

Recording Record(const Lattice& lattice, const World& world, const Hands& hands) {
  const ModelPtr model = Compile(world.Mjcf());
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
  for (int frame = 0; frame < kFrames; ++frame) {
    recording.points.emplace_back(lattice.nodes +
                                  Eigen::Map<const Points>(data->qpos, 3, lattice.nodes.cols()));
    recording.controllers.emplace_back(lattice.held.colwise() + hands.At(frame / kFps));
    for (int step = 0; step < kSteps; ++step) {
      const double time = frame / kFps + step * kTimestep;
      world.Drive(time, model.get(), data.get());
      Eigen::Map<Points>(data->mocap_pos, 3, lattice.held.cols()) =
          lattice.held.colwise() + hands.At(time + kTimestep - world.latency());
      Step(*model, data.get());
    }
  }
  return recording;
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

const std::vector<std::string>& UndeclaredEffects() {
  static const std::vector<std::string> kEffects = {
      "air_drag",        "gravity_direction", "stiffening",       "tension_only", "yield",
      "dry_friction",    "mass_distribution", "tether",           "rest_length",  "control_latency",
      "stiffness_drift", "uniform_force",     "moving_attraction"};
  return kEffects;
}

MadeRecordings MakeWithEffect(Body body, const std::string& effect, double noise,
                              std::uint64_t seed) {
  Random random(seed);
  const Lattice lattice = MakeLattice(body);
  const World world(lattice, effect, random(0.8, 1.6), &random);
  const World clean(lattice, "none", 1, &random);
  const Hands first(&random), second(&random);
  MadeRecordings made{Record(lattice, world, first), Record(lattice, world, second), 0};
  const Recording without = Record(lattice, clean, first);
  for (int t = 1; t < kFrames; ++t) {
    made.displacement += (made.fit.points[t] - without.points[t]).colwise().norm().mean();
  }
  made.displacement /= kFrames - 1;
  made.fit.name = effect + " fit", made.other.name = effect + " other";
  made.fit.hash = "fit", made.other.hash = "other";
  AddNoise(noise, &random, &made.fit);
  AddNoise(noise, &random, &made.other);
  return made;
}

}  // namespace physpring

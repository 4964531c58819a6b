// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/force_scale.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "twin/effects/effect_set.h"
#include "twin/effects/registry.h"
#include "twin/predict.h"
#include "twin/recorded_input.h"
#include "twin/simulator.h"

namespace physpring {
namespace {

// The forces with which the controllers pull at the springs, 3 x controllers, N.
Points ForcesOfControllers(const SpringMassSystem& system, const Eigen::VectorXd& rest_length,
                           const Points& position, const Points& velocity, const Points& hands,
                           const Points& hand_velocity, const ControllerMask& released) {
  const int nodes = system.node_count();
  Points force = Points::Zero(3, system.controllers);
  for (int e = 0; e < system.spring_count(); ++e) {
    if (!system.IsControllerSpring(e)) continue;
    const auto [a, b] = std::minmax(system.springs[e][0], system.springs[e][1]);
    const int hand = b - nodes;
    if (Has(released, hand)) continue;
    const Eigen::Vector3d d = hands.col(hand) - position.col(a);
    const double length = d.norm();
    const Eigen::Vector3d n = d / length;
    const double rate = (hand_velocity.col(hand) - velocity.col(a)).dot(n);
    force.col(hand) +=
        (system.stiffness[e] * (length - rest_length[e]) + system.dashpot[e] * rate) * n;
  }
  return force;
}

// Sums over what was measured.
struct Sums {
  double product = 0, square = 0, square_of_measured = 0;  // f . F, f . f, F . F

  double Factor() const { return product / square; }
  bool Agree() const {
    constexpr double kLeastCorrelation = 0.5, kMost = 1e4;
    const double factor = Factor();
    return product > kLeastCorrelation * std::sqrt(square * square_of_measured) && factor < kMost &&
           factor > 1 / kMost;
  }

  void Add(const Eigen::MatrixXd& force, const Points& of_twin) {
    const Eigen::MatrixXd f =
        force.rows() == 3 ? Eigen::MatrixXd(of_twin) : Eigen::MatrixXd(of_twin.colwise().norm());
    for (Eigen::Index i = 0; i < force.size(); ++i) {
      if (std::isnan(force.data()[i])) continue;
      product += f.data()[i] * force.data()[i];
      square += f.data()[i] * f.data()[i];
      square_of_measured += force.data()[i] * force.data()[i];
    }
  }
};

void AddRecording(const Twin& twin, const Recording& recording, Sums* sums) {
  const SpringMassSystem& system = twin.levels[0].system;
  const SimulationOptions options{1 / recording.fps,
                                  ChooseSubsteps(twin.levels[0], recording.fps, 0),
                                  twin.controller_velocity, LateGraspsOf(recording)};
  const Simulator<double> simulator(system, EnvironmentOf(recording), options);
  const SpringMassSystem changed = ApplyEffects(system, recording.gravity).system;
  const double delay = ControllerDelay(system);
  Simulator<double>::Workspace workspace(simulator);
  auto state =
      simulator.MakeState(recording.start.leftCols(recording.particle_count()), recording.velocity);
  for (int frame = 1; frame < recording.train_frames; ++frame) {
    const FrameInput input = RecordedInput(recording, frame, delay);
    simulator.AdvanceFrame(input, &state, &workspace);
    Points velocity = (input.controllers_end - input.controllers_start) * recording.fps;
    if (!twin.controller_velocity) velocity.setZero();
    sums->Add(recording.force[static_cast<std::size_t>(frame)],
              ForcesOfControllers(changed, simulator.RestLengths(state), simulator.Positions(state),
                                  simulator.Velocities(state), input.controllers_end, velocity,
                                  input.released));
  }
}

// Whether the unit at the end of a parameter's key is that of a force: "mass_kg",
// "damping_n_s_per_m", not "slip_curvature_per_m".
bool IsOfForce(const std::string& key) {
  std::istringstream words(key);
  for (std::string word; std::getline(words, word, '_') && word != "per";) {
    if (word == "n" || word == "kg") return true;
  }
  return false;
}

void Scale(double factor, SpringMassSystem* system) {
  system->mass *= factor;
  system->stiffness *= factor;
  system->dashpot *= factor;
  for (EffectValues& effect : system->effects) {
    Eigen::Index first = 0;
    for (const EffectParameter& parameter : GetEffect(effect.name).parameters()) {
      if (IsOfForce(parameter.key)) effect.values.segment(first, parameter.count) *= factor;
      first += parameter.count;
    }
  }
}

void Scale(double factor, Material* material) {
  for (Material::LengthClass& one : material->classes) {
    Estimate& stiffness = one.axial_stiffness;
    stiffness = {factor * stiffness.value, factor * stiffness.low, factor * stiffness.high};
  }
}

}  // namespace

void ScaleToForces(const FitData& data, Twin* twin) {
  Sums sums;
  for (const Recording& recording : data.recordings) {
    if (!recording.force.empty()) AddRecording(*twin, recording, &sums);
  }
  if (!sums.Agree()) return;
  const double factor = sums.Factor();
  for (TwinLevel& level : twin->levels) Scale(factor, &level.system);
  if (twin->material) Scale(factor, &*twin->material);
  twin->force_scale = factor;
}

}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
#include "tests/support/targeted_rollout.h"

#include <fmt/format.h>

#include "tests/support/random_system.h"

namespace physpring {
namespace {

Points LossGradient(const TargetedRollout& rollout, std::size_t frame, const Points& position) {
  return rollout.weight[frame].cwiseProduct(position - rollout.target[frame]);
}

template <class Derived>
void AddEntries(const std::string& name, Eigen::PlainObjectBase<Derived>* variables,
                const Derived& derivative, double step, std::vector<CheckedVariable>* checked) {
  for (Eigen::Index i = 0; i < variables->size(); ++i) {
    checked->push_back(
        {fmt::format("{} {}", name, i), variables->data() + i, step, derivative.data()[i]});
  }
}

}  // namespace

TargetedRollout RandomRollout(int count, std::uint64_t seed) {
  Random random(seed + 1000);
  TargetedRollout rollout;
  rollout.system = RandomSystem(25, 2, seed);
  rollout.options = {.frame_time = 0.01, .substeps = 10, .controller_velocity = true};
  const int nodes = rollout.system.node_count();
  rollout.position = rollout.system.position.leftCols(nodes) + random.Box(nodes, 0.01);
  rollout.velocity = random.Box(nodes, 0.3);
  Points hands = rollout.system.position.rightCols(rollout.system.controllers);
  for (int frame = 0; frame < count; ++frame) {
    const Points next = hands + random.Box(rollout.system.controllers, 0.01);
    rollout.frames.push_back({hands, next, {}});
    hands = next;
    rollout.target.emplace_back(rollout.position + random.Box(nodes, 0.05));
    rollout.weight.emplace_back((random.Box(nodes, 1).array() + 1.5).matrix());
  }
  return rollout;
}

template <class Real>
std::vector<Points> Simulate(const TargetedRollout& rollout) {
  const Simulator<Real> simulator(rollout.system, rollout.environment, rollout.options);
  typename Simulator<Real>::Workspace workspace(simulator);
  NodeStates<Real> state = simulator.MakeState(rollout.position, rollout.velocity);
  std::vector<Points> positions;
  for (const FrameInput& input : rollout.frames) {
    simulator.AdvanceFrame(input, &state, &workspace);
    positions.push_back(simulator.Positions(state));
  }
  return positions;
}

template <class Real>
long double Loss(const TargetedRollout& rollout) {
  const std::vector<Points> positions = Simulate<Real>(rollout);
  long double loss = 0;
  for (std::size_t frame = 0; frame < positions.size(); ++frame) {
    const Points difference = positions[frame] - rollout.target[frame];
    for (double term : difference.cwiseAbs2().cwiseProduct(rollout.weight[frame]).reshaped()) {
      loss += 0.5L * term;
    }
  }
  return loss;
}

template <class Real>
RolloutGradient Gradient(const TargetedRollout& rollout) {
  const Simulator<Real> simulator(rollout.system, rollout.environment, rollout.options);
  typename Simulator<Real>::Workspace workspace(simulator);
  std::vector<NodeStates<Real>> states{simulator.MakeState(rollout.position, rollout.velocity)};
  for (const FrameInput& input : rollout.frames) {
    states.push_back(states.back());
    simulator.AdvanceFrame(input, &states.back(), &workspace);
  }
  const int nodes = simulator.node_count();
  RolloutGradient gradient{SystemGradient(rollout.system), {}, {}, {}, {}};
  gradient.controllers_start.resize(rollout.frames.size());
  gradient.controllers_end.resize(rollout.frames.size());
  NodeStates<Real> state_bar(states[0].size());
  for (std::size_t frame = rollout.frames.size(); frame-- > 0;) {
    const Points bar = LossGradient(rollout, frame, simulator.Positions(states[frame + 1]));
    for (int i = 0; i < nodes; ++i) {
      for (int j = 0; j < 3; ++j) state_bar[i].x[j] += static_cast<Real>(bar(j, i));
    }
    simulator.AdvanceFrameAdjoint(states[frame], rollout.frames[frame], &state_bar,
                                  &gradient.system, &workspace);
    gradient.controllers_start[frame] = workspace.controllers_start_bar();
    gradient.controllers_end[frame] = workspace.controllers_end_bar();
  }
  gradient.position = simulator.Positions(state_bar);
  gradient.velocity = simulator.Velocities(state_bar);
  return gradient;
}

std::vector<GradientReport> CheckRollout(TargetedRollout rollout, double step) {
  const RolloutGradient gradient = Gradient<double>(rollout);
  SpringMassSystem& system = rollout.system;
  ContactCoefficients& contact = system.contact;
  const SystemGradient& exact = gradient.system;
  std::vector<std::vector<CheckedVariable>> quantities(9);
  AddEntries("stiffness", &system.stiffness, exact.stiffness, 400 * step, &quantities[0]);
  AddEntries("rest length", &system.rest_length, exact.rest_length, 0.1 * step, &quantities[1]);
  AddEntries("dashpot", &system.dashpot, exact.dashpot, 3 * step, &quantities[2]);
  AddEntries("mass", &system.mass, exact.mass, 0.1 * step, &quantities[3]);
  AddEntries("gravity", &rollout.environment.gravity, exact.gravity, 10 * step, &quantities[4]);
  AddEntries("position", &rollout.position, gradient.position, 0.1 * step, &quantities[5]);
  AddEntries("velocity", &rollout.velocity, gradient.velocity, 3 * step, &quantities[6]);
  quantities[7] = {{"drag", &system.drag, 0.5 * step, exact.drag}};
  for (std::size_t i = 0; i < rollout.frames.size(); ++i) {
    AddEntries("controllers at the start", &rollout.frames[i].controllers_start,
               gradient.controllers_start[i], 0.1 * step, &quantities[8]);
    AddEntries("controllers at the end", &rollout.frames[i].controllers_end,
               gradient.controllers_end[i], 0.1 * step, &quantities[8]);
  }
  const ContactLaws<double>& laws = exact.contact;
  for (const auto& [name, object_name, most, member] : kContactCoefficients<double>) {
    quantities.push_back({{name, &(contact.surface.*member), 0.5 * step, laws.surface.*member}});
    quantities.push_back(
        {{object_name, &(contact.object.*member), 0.5 * step, laws.object.*member}});
  }

  std::vector<GradientReport> reports;
  for (const std::vector<CheckedVariable>& variables : quantities) {
    reports.push_back(CheckGradient([&] { return Loss<double>(rollout); }, variables));
  }
  return reports;
}

template std::vector<Points> Simulate<float>(const TargetedRollout&);
template std::vector<Points> Simulate<double>(const TargetedRollout&);
template long double Loss<float>(const TargetedRollout&);
template long double Loss<double>(const TargetedRollout&);
template RolloutGradient Gradient<float>(const TargetedRollout&);
template RolloutGradient Gradient<double>(const TargetedRollout&);

}  // namespace physpring

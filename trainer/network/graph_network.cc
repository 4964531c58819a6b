// SPDX-License-Identifier: Apache-2.0
#include "trainer/network/graph_network.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "trainer/bodies/contact_logits.h"

namespace physpring {
namespace {

constexpr int kOctaves = 5;
constexpr int kNodeInputs = 3 + 1 + 2 + 3 * 2 * kOctaves;  // position, mass, type, encoding
constexpr int kSpringInputs = 3 + 1 + 2 + 2;               // extent, length, k and c, type
const double kMostStiffness = std::log(10.0), kMostDashpot = std::log(4.0),
             kMostDrag = std::log(4.0), kMostContact = 3;

bool IsController(const SpringMassSystem& system, int column) {
  return column >= system.node_count();
}

// Rows: the body's principal axes, each by the body's extent along it, so that every direction
// counts alike however thin the body is; directions in which it has none by its greatest.
Eigen::Matrix3d ScaledAxes(const Points& centred) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> moments(centred * centred.transpose());
  const Eigen::Matrix3d axes = moments.eigenvectors().transpose();
  const Points along = axes * centred;
  const Eigen::Vector3d extent = along.rowwise().maxCoeff() - along.rowwise().minCoeff();
  const double most = std::max(extent.maxCoeff(), 1e-9);
  constexpr double kFlat = 0.01;
  const Eigen::Vector3d scale =
      (extent.array() > kFlat * most).select(extent.cwiseInverse(), 1 / most);
  return scale.asDiagonal() * axes;
}

// Position along the scaled axes, log of mass by mean mass, type (free node, controller), sin and
// cos of 2^o pi x.
Features NodeInputs(const SpringMassSystem& system) {
  const Points& x = system.position;
  const Points nodes = x.leftCols(system.node_count());
  const Eigen::Vector3d centre = nodes.rowwise().mean();
  const Eigen::Matrix3d axes = ScaledAxes(nodes.colwise() - centre);
  Features inputs = Features::Zero(x.cols(), kNodeInputs);
  for (int i = 0; i < x.cols(); ++i) {
    const Eigen::Vector3d scaled = axes * (x.col(i) - centre);
    inputs.row(i).head<3>() = scaled.transpose();
    const bool controller = IsController(system, i);
    if (!controller) inputs(i, 3) = std::log(system.mass[i] / system.mass.mean());
    inputs(i, controller ? 5 : 4) = 1;
    for (int octave = 0; octave < kOctaves; ++octave) {
      const Eigen::Vector3d phase = std::ldexp(M_PI, octave) * scaled;
      inputs.row(i).segment<3>(6 + 6 * octave) = phase.array().sin().transpose();
      inputs.row(i).segment<3>(9 + 6 * octave) = phase.array().cos().transpose();
    }
  }
  return inputs;
}

// log(v / mean v), 0 where v is 0.
double LogOfMean(double value, double mean) {
  return value > 0 && mean > 0 ? std::clamp(std::log(value / mean), -5.0, 5.0) : 0;
}

Features SpringInputs(const SpringMassSystem& system) {
  const int springs = system.spring_count();
  Features inputs = Features::Zero(springs, kSpringInputs);
  const double length = system.rest_length.mean(), k = system.stiffness.mean(),
               c = system.dashpot.mean();
  for (int e = 0; e < springs; ++e) {
    const auto [a, b] = system.springs[e];
    const Eigen::Vector3d d = (system.position.col(b) - system.position.col(a)) / length;
    inputs.row(e).head<3>() = d.cwiseAbs().transpose();
    inputs(e, 3) = d.norm();
    inputs(e, 4) = LogOfMean(system.stiffness[e], k);
    inputs(e, 5) = LogOfMean(system.dashpot[e], c);
    inputs(e, IsController(system, std::max(a, b)) ? 7 : 6) = 1;
  }
  return inputs;
}

std::vector<int> Ends(const SpringMassSystem& system, int end) {
  std::vector<int> ends;
  for (const auto& spring : system.springs) ends.push_back(spring[end]);
  return ends;
}

// The coarse node of each fine one, controllers included.
std::vector<int> WithControllers(const Assignment& assignment, int controllers) {
  std::vector<int> rows = assignment;
  rows.resize(assignment.size() + controllers);
  std::iota(rows.begin() + static_cast<std::ptrdiff_t>(assignment.size()), rows.end(),
            CountClusters(assignment));
  return rows;
}

}  // namespace

GraphNetwork::GraphNetwork(int latent, std::uint64_t seed) {
  WeightLayout layout(seed);
  encode_node_ = layout.TwoLayers(kNodeInputs, latent, latent);
  encode_spring_ = layout.TwoLayers(kSpringInputs, latent, latent);
  for (int step = 0; step < kEncoderSteps + 1; ++step) {
    MessageStep& s = steps_.emplace_back();
    s.spring = layout.Linear(latent, latent);
    s.ends = layout.Linear(latent, latent);
    s.node = layout.Linear(latent, latent);
    s.message = layout.Linear(latent, latent);
  }
  spring_head_ = layout.TwoLayers(latent, latent, 2, true);
  system_head_ = layout.TwoLayers(latent, latent, 1 + kContactCount, true);
  first_weights_ = layout.Values();
}

Eigen::VectorXd GraphNetwork::WithoutCorrections(Eigen::VectorXd weights) const {
  for (const Mlp* head : {&spring_head_, &system_head_}) {
    const LinearLayer& last = head->second;
    weights.segment(last.offset, (last.inputs + 1) * last.outputs).setZero();
  }
  return weights;
}

void GraphNetwork::Messages(const SpringMassSystem& system, Encoded* encoded, int step,
                            Tape* tape) const {
  const MessageStep& s = steps_[step];
  const std::vector<int> a = Ends(system, 0), b = Ends(system, 1);
  const int nodes = static_cast<int>(system.position.cols());
  // e <- e + swish N(W_e e + W_n (h_a + h_b))
  const Tape::Node ends = s.ends.Apply(tape, encoded->nodes);
  const Tape::Node both = tape->Sum(tape->Gather(ends, a), tape->Gather(ends, b));
  const Tape::Node mixed = tape->Sum(s.spring.Apply(tape, encoded->springs), both);
  encoded->springs = tape->Sum(encoded->springs, tape->Swish(tape->Normalise(mixed)));
  // h <- h + swish N(W_h h + W_m mean e)
  const Tape::Node mean = tape->Sum(tape->MeanInto(encoded->springs, a, nodes),
                                    tape->MeanInto(encoded->springs, b, nodes));
  const Tape::Node heard =
      tape->Sum(s.node.Apply(tape, encoded->nodes), s.message.Apply(tape, mean));
  encoded->nodes = tape->Sum(encoded->nodes, tape->Swish(tape->Normalise(heard)));
}

GraphNetwork::Encoded GraphNetwork::Encode(const std::vector<Level>& levels, Tape* tape) const {
  Encoded encoded{encode_node_.Apply(tape, tape->Constant(NodeInputs(*levels[0].system))),
                  encode_spring_.Apply(tape, tape->Constant(SpringInputs(*levels[0].system)))};
  for (std::size_t l = 0; l < levels.size(); ++l) {
    const SpringMassSystem& system = *levels[l].system;
    if (l > 0) {
      encoded.nodes =
          tape->MeanInto(encoded.nodes, WithControllers(levels[l].assignment, system.controllers),
                         static_cast<int>(system.position.cols()));
      encoded.springs =
          tape->Sum(tape->MeanInto(encoded.springs, levels[l].spring, system.spring_count()),
                    encode_spring_.Apply(tape, tape->Constant(SpringInputs(system))));
    }
    for (int step = 0; step < kEncoderSteps; ++step) Messages(system, &encoded, step, tape);
  }
  return encoded;
}

GraphNetwork::Corrections GraphNetwork::Decode(const SpringMassSystem& system,
                                               const Encoded& encoded, Tape* tape) const {
  Encoded decoded = encoded;
  Messages(system, &decoded, kEncoderSteps, tape);
  const Tape::Node skipped = tape->Sum(decoded.springs, encoded.springs);
  return {
      tape->BoundedBy(spring_head_.Apply(tape, tape->Normalise(skipped)), kMostStiffness),
      tape->BoundedBy(system_head_.Apply(tape, tape->MeanOfRows(tape->Normalise(decoded.nodes))),
                      kMostContact)};
}

SpringMassSystem ApplyCorrections(const SpringMassSystem& base, const Features& springs,
                                  const Features& system) {
  SpringMassSystem corrected = base;
  for (int e = 0; e < base.spring_count(); ++e) {
    corrected.stiffness[e] *= std::exp(springs(e, 0));
    corrected.dashpot[e] *= std::exp(kMostDashpot / kMostStiffness * springs(e, 1));
  }
  corrected.drag *= std::exp(kMostDrag / kMostContact * system(0, 0));
  MoveLogits(system.row(0).tail<kContactCount>().transpose(), &corrected.contact.surface);
  return corrected;
}

void CorrectionsAdjoint(const SpringMassSystem& corrected, const SystemGradient& gradient,
                        Features* springs_bar, Features* system_bar) {
  springs_bar->resize(corrected.spring_count(), 2);
  // forward: y = base exp(s x), so x_bar = y_bar y s
  springs_bar->col(0) = gradient.stiffness.cwiseProduct(corrected.stiffness);
  springs_bar->col(1) =
      kMostDashpot / kMostStiffness * gradient.dashpot.cwiseProduct(corrected.dashpot);
  system_bar->resize(1, 1 + kContactCount);
  (*system_bar)(0, 0) = kMostDrag / kMostContact * gradient.drag * corrected.drag;
  system_bar->row(0).tail<kContactCount>() =
      MoveLogitsAdjoint(corrected.contact.surface, gradient.contact.surface).transpose();
}

}  // namespace physpring

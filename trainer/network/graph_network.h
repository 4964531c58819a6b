// SPDX-License-Identifier: Apache-2.0
// The graph network of PhySPRING (paper, section 3.2). For each level:
//   encoder  h_i = Enc_v[x_i, log m_i, type, sin / cos of 5 octaves of x_i] at level 0, the mean of
//            the members' features above; e_ij = Enc_e[|x_i - x_j| by axis and in all, log k, log
//            c, type], plus the mean of the finer springs' features above
//   message  e <- e + swish N(W_e e + W_n (h_i + h_j)),   h <- h + swish N(W_h h + W_m mean e)
//            (N: layer norm), twice; the same weights at all levels
//   decoder  one more message step, and heads that read corrections of the Galerkin estimates:
//            log-stiffness within ln 10 and log-dashpot within ln 4 from e of each spring (plus
//            what the encoder had: a skip connection), log-drag within ln 4 and the logits of the
//            ground's coefficients of contact within 3 from the mean of h
// Positions are taken along the body's principal axes, each by the body's extent along it.
// The heads' last layers start at 0, so that the first corrections are 0. Springs have no
// direction: a feature does not depend on which end is named first. Controllers are nodes with a
// type of their own, at all levels the same.
#ifndef PHYSPRING_TRAINER_NETWORK_GRAPH_NETWORK_H_
#define PHYSPRING_TRAINER_NETWORK_GRAPH_NETWORK_H_

#include <cstdint>
#include <vector>

#include "trainer/network/weights.h"
#include "trainer/projection/galerkin.h"
#include "twin/simulator.h"
#include "twin/spring_mass_system.h"

namespace physpring {

class GraphNetwork {
 public:
  GraphNetwork(int latent, std::uint64_t seed);

  // A level as the network sees it: its system, and how it is projected from the level below (empty
  // at level 0).
  struct Level {
    const SpringMassSystem* system;
    Assignment assignment;
    std::vector<int> spring;  // Projection::spring
  };

  const Eigen::VectorXd& first_weights() const { return first_weights_; }
  // These weights with the heads' last layers at 0: all corrections are 0.
  Eigen::VectorXd WithoutCorrections(Eigen::VectorXd weights) const;

  struct Encoded {
    Tape::Node nodes, springs;  // (nodes + controllers) x latent, springs x latent
  };
  // Features of the last of `levels`, which are those of a twin so far, from level 0 on.
  Encoded Encode(const std::vector<Level>& levels, Tape* tape) const;

  struct Corrections {
    Tape::Node springs;  // springs x 2: those of log-stiffness and log-dashpot
    Tape::Node system;   // 1 row: those of log-drag and of the logits of the contact's coefficients
  };
  Corrections Decode(const SpringMassSystem& system, const Encoded& encoded, Tape* tape) const;

 private:
  void Messages(const SpringMassSystem& system, Encoded* encoded, int step, Tape* tape) const;

  static constexpr int kEncoderSteps = 2;
  Eigen::VectorXd first_weights_;
  Mlp encode_node_, encode_spring_;
  struct MessageStep {
    LinearLayer spring, ends, node, message;
  };
  std::vector<MessageStep> steps_;  // the encoder's, then the decoder's
  Mlp spring_head_, system_head_;
};

// The corrections applied to a system, and the derivatives with respect to them.
SpringMassSystem ApplyCorrections(const SpringMassSystem& base, const Features& springs,
                                  const Features& system);
void CorrectionsAdjoint(const SpringMassSystem& corrected, const SystemGradient& gradient,
                        Features* springs_bar, Features* system_bar);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_NETWORK_GRAPH_NETWORK_H_

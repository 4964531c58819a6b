// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_TRAINER_DATA_TRAIN_OPTIONS_H_
#define PHYSPRING_TRAINER_DATA_TRAIN_OPTIONS_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "twin/effects/effect_values.h"
#include "twin/friction_cone.h"

namespace physpring {

struct TrainOptions {
  enum class Method { kFull, kSmooth, kTwoStage };
  Method method = Method::kFull;
  // Of single springs. Automatic: Gauss-Newton while it gets on, then Adam, which goes on where
  // contacts or chaotic motions make the residuals too rough for it.
  enum class Optimizer { kAutomatic, kGaussNewton, kAdam };
  Optimizer optimizer = Optimizer::kAutomatic;
  std::vector<int> neighbours;  // candidates for the neighbour count; empty: chosen automatically
  int epochs = 0;               // of the last stage; 0: the method's default
  int substeps = 0;             // a frame; 0: from the stability bound
  bool single_precision = false;
  // Whether dashpots feel the controllers' velocity; empty: whatever predicts better, no
  // (two-stage, as PhysTwin).
  std::optional<bool> controller_velocity;
  // Of friction on the ground; empty: whatever predicts better, elliptic (two-stage).
  std::optional<FrictionCone> cone;
  bool self_collision = false;        // particles collide with each other (two-stage only)
  std::vector<EffectValues> effects;  // that the twin has, with these values (not two-stage)
  int threads = 1;
  std::uint64_t seed = 0;

  // The hierarchy: `levels` in all, level l >= 1 with ratios[l - 1] of the nodes of level 0.
  int levels = 1;
  std::vector<double> ratios = {0.6, 0.4, 0.3};
  std::string reduction = "learned";  // the name of one in reduction/registry.h

  // The graph network; values of the paper (PhySPRING, arXiv 2605.07687).
  struct Network {
    int latent = 128;
    int epochs = 20;  // of each level
    int updates = 1;  // an epoch (the paper's K_model)
    double learning_rate = 1e-3;
    double decay = 0.9;          // of the learning rate, an epoch
    int contact_updates = 1;     // of the contact's coefficients after each epoch (K_col)
    double contact_rate = 1e-2;  // of their logits
    // What decides which nodes a learned reduction joins: the features of the network, which learn;
    // those of one that stays as it was drawn; nothing but rest positions.
    enum class Features { kLearned, kUntrained, kPositions };
    Features features = Features::kLearned;
  };
  Network network;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_DATA_TRAIN_OPTIONS_H_

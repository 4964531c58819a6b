// SPDX-License-Identifier: Apache-2.0
// The options that the result of a training depends on, listed once. They are flags of `physpring
// train`, keyword arguments in Python, and the JSON that a twin keeps (train_options_json.h).
#ifndef PHYSPRING_JOBS_TRAIN_OPTION_LIST_H_
#define PHYSPRING_JOBS_TRAIN_OPTION_LIST_H_

#include <optional>

#include "jobs/word.h"
#include "trainer/data/train_options.h"
#include "twin/cone_name.h"

namespace physpring {

inline constexpr Word<TrainOptions::Method> kMethodWords[] = {
    {"full", TrainOptions::Method::kFull},
    {"smooth", TrainOptions::Method::kSmooth},
    {"two-stage", TrainOptions::Method::kTwoStage}};

inline constexpr Word<TrainOptions::Optimizer> kOptimizerWords[] = {
    {"auto", TrainOptions::Optimizer::kAutomatic},
    {"gauss-newton", TrainOptions::Optimizer::kGaussNewton},
    {"adam", TrainOptions::Optimizer::kAdam}};

inline constexpr Word<TrainOptions::Network::Features> kFeatureWords[] = {
    {"learned", TrainOptions::Network::Features::kLearned},
    {"untrained", TrainOptions::Network::Features::kUntrained},
    {"positions", TrainOptions::Network::Features::kPositions}};

inline constexpr Word<std::optional<bool>> kVelocityWords[] = {
    {"auto", std::nullopt}, {"on", true}, {"off", false}};

inline constexpr Word<std::optional<FrictionCone>> kConeWords[] = {
    {"auto", std::nullopt},
    {kElliptic, FrictionCone::kElliptic},
    {kPyramidal, FrictionCone::kPyramidal}};

// The options of coarse levels. A visitor is told of each name, its value, what it may be, and the
// help.
template <class Options, class Visitor>
void VisitHierarchyOptions(Options& options, Visitor& visit) {
  visit.Ratios("ratios", &options.ratios, options.levels,
               "nodes of levels 1, 2, ... as parts of level 0's particles");
  visit.Reduction("reduction", &options.reduction, "which nodes become one coarser one");
  auto& network = options.network;
  visit.Choice("features", &network.features, kFeatureWords,
               "of nodes, by which a reduction that learns joins them: the network's, those of a "
               "network that does not learn, or positions at rest");
  visit.Count("network-epochs", &network.epochs, 0, 10000, "of each level; 0: no corrections");
  visit.Count("network-updates", &network.updates, 1, 1000, "of the network in an epoch (K_model)");
  visit.Count("contact-updates", &network.contact_updates, 0, 1000,
              "of the ground's contact alone after each epoch (K_col)");
  visit.Count("latent", &network.latent, 2, 1024, "features of a node in the network");
}

template <class Options, class Visitor>
void VisitFitOptions(Options& options, Visitor& visit) {
  visit.Neighbours(
      "neighbours", &options.neighbours,
      "springs of a particle; of several the best on held-back frames (not two-stage)");
  visit.Choice("optimizer", &options.optimizer, kOptimizerWords, "of single springs (full)");
  visit.CountOrAuto("epochs", &options.epochs, "steps of the last stage");
  visit.CountOrAuto("substeps", &options.substeps,
                    "sub-steps of a frame; auto: as many as are stable");
  visit.Choice("precision", &options.single_precision, kPrecisionWords, "of the simulation");
  visit.Choice("controller-velocity", &options.controller_velocity, kVelocityWords,
               "whether dashpots feel the controllers' velocity; auto: what leaves less in a fit, "
               "no (two-stage)");
  visit.Choice("cone", &options.cone, kConeWords,
               "of friction on the ground: Coulomb's, or MuJoCo's default; auto: whatever predicts "
               "better, elliptic (two-stage)");
  visit.Flag("self-collision", &options.self_collision,
             "let particles collide with each other (two-stage)");
}

// All options. The coarse levels' are left out of a twin that has none.
template <class Options, class Visitor>
void VisitTrainOptions(Options& options, Visitor& visit) {
  visit.Choice("method", &options.method, kMethodWords,
               "full: a smooth body of few numbers, or single springs where they predict better; "
               "smooth: the smooth body; two-stage: as PhysTwin does");
  visit.Count("levels", &options.levels, 1, 10, "levels of the twin, level 0 included");
  if (visit.all() || options.levels > 1) VisitHierarchyOptions(options, visit);
  VisitFitOptions(options, visit);
}

}  // namespace physpring

#endif  // PHYSPRING_JOBS_TRAIN_OPTION_LIST_H_

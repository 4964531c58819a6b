// SPDX-License-Identifier: Apache-2.0
// The words for what `physpring train` is asked for: in its flags, and in the options that a twin
// file keeps.
#ifndef PHYSPRING_CLI_TRAIN_WORDS_H_
#define PHYSPRING_CLI_TRAIN_WORDS_H_

#include <optional>

#include "cli/option_values.h"
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

}  // namespace physpring

#endif  // PHYSPRING_CLI_TRAIN_WORDS_H_

// SPDX-License-Identifier: Apache-2.0
// The options of a training as JSON: what a twin keeps and a training that resumes compares, and
// how Python gives them.
#ifndef PHYSPRING_JOBS_TRAIN_OPTIONS_JSON_H_
#define PHYSPRING_JOBS_TRAIN_OPTIONS_JSON_H_

#include <optional>
#include <string>

#include "trainer/data/train_options.h"

namespace physpring {

// {"method": "full", ...}: a key for each option of the list, with "_" for "-", and the effects.
// `from`: the file that level 0 comes from; empty: it is fitted. The seed has a place of its own in
// a twin.
std::string TrainOptionsJson(const TrainOptions& options, const std::string& from);

// The other way round, for keys of the list; those that are missing have their defaults. Throws
// Error that names the key and what it may be.
TrainOptions ParseTrainOptions(const std::string& json);

// Where a training takes what it does not fit.
struct TrainSources {
  bool from = false;     // level 0 is that of a twin
  bool effects = false;  // the effects are those of a twin
};

// An option of the list, "from" or "effects", and why it makes no sense with the others.
struct TrainOptionsError {
  std::string option, why;
};

// The first one, if there is any.
std::optional<TrainOptionsError> CheckTrainOptions(const TrainOptions& options,
                                                   const TrainSources& sources);

}  // namespace physpring

#endif  // PHYSPRING_JOBS_TRAIN_OPTIONS_JSON_H_

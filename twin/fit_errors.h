// SPDX-License-Identifier: Apache-2.0
// How well a twin's level 0 predicts the recordings that it was trained on, so that whoever has the
// twin without them knows.
#ifndef PHYSPRING_TWIN_FIT_ERRORS_H_
#define PHYSPRING_TWIN_FIT_ERRORS_H_

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "twin/json_fields.h"

namespace physpring {

// Mean distances from the measured points, m; means over recordings.
struct FitErrors {
  double track = 0;             // in the frames for fitting
  double motionless = 0;        // in the same, of a body that does not move
  std::optional<double> later;  // in the frames after them, if there are any
  double noise = 0;             // of a measured coordinate, standard deviation
  double correlation = 0;       // of the errors of one frame and the next

  bool LeavesNoise() const;
};

// Errors that correlate less are noise. Those of true bodies that are networks have -0.01 to 0.04,
// those of side valleys 0.4 to 0.9.
inline constexpr double kNoiseCorrelation = 0.1;

inline bool FitErrors::LeavesNoise() const { return correlation < kNoiseCorrelation; }

nlohmann::ordered_json FitErrorsToJson(const FitErrors& errors);

// Throws Error for an object that is not of FitErrorsToJson's form.
FitErrors FitErrorsFromJson(const JsonFields& fields);

// "on the fit frames: 1.234 mm (a motionless body: 98.765 mm); on the later ones: 2.345 mm".
std::string DescribeFitErrors(const FitErrors& errors);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_FIT_ERRORS_H_

// SPDX-License-Identifier: Apache-2.0
#include "twin/fit_errors.h"

#include <fmt/format.h>

namespace physpring {

nlohmann::ordered_json FitErrorsToJson(const FitErrors& errors) {
  nlohmann::ordered_json json = {{"track_m", errors.track},
                                 {"motionless_m", errors.motionless},
                                 {"noise_m", errors.noise},
                                 {"correlation", errors.correlation}};
  if (errors.later) json["later_m"] = *errors.later;
  return json;
}

FitErrors FitErrorsFromJson(const JsonFields& fields) {
  fields.ExpectOnly({"track_m", "motionless_m", "noise_m", "correlation", "later_m"});
  FitErrors errors{fields.Number("track_m"), fields.Number("motionless_m"), std::nullopt,
                   fields.Number("noise_m"), fields.Number("correlation")};
  if (fields.Has("later_m")) errors.later = fields.Number("later_m");
  return errors;
}

std::string DescribeFitErrors(const FitErrors& errors) {
  std::string text = fmt::format("on the fit frames: {:.3f} mm (a motionless body: {:.3f} mm)",
                                 1e3 * errors.track, 1e3 * errors.motionless);
  if (errors.later) text += fmt::format("; on the later ones: {:.3f} mm", 1e3 * *errors.later);
  return text;
}

}  // namespace physpring

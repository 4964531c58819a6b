// SPDX-License-Identifier: Apache-2.0
#include "jobs/diagnosis_input.h"

#include <fmt/format.h>

#include <cmath>

#include "twin/error.h"
#include "twin/grasps.h"
#include "twin/numbering.h"

namespace physpring {
namespace {

// Throws Error if one of `recordings`, which come from `paths`, is one of `others`, or a copy.
void ExpectNoneAmong(const std::vector<Recording>& others, const std::vector<Recording>& recordings,
                     const std::vector<std::string>& paths, const char* what, const char* why) {
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    for (const Recording& other : others) {
      if (other.hash != recordings[i].hash) continue;
      throw Error(fmt::format("{}: is among the recordings {}, too, as {}; {}", paths.at(i), what,
                              other.name, why));
    }
  }
}

void ExpectLastingGrasps(const Recording& recording) {
  if (!HasChangingGrasps(recording)) return;
  throw Error(fmt::format(
      "recording {}: has grasps that begin or end ('held'), which cannot be diagnosed yet",
      recording.name));
}

}  // namespace

void ExpectApart(const DiagnosisInput& input) {
  ExpectNoneAmong(input.data.recordings, input.judged, input.judged_paths, "to fit",
                  "it cannot judge them");
  for (const auto* others : {&input.data.recordings, &input.judged}) {
    ExpectNoneAmong(*others, input.before, input.before_paths, "to diagnose",
                    "it is from before the change or from after it");
  }
}

bool MayBeFromBefore(const Twin& twin, const DiagnosisInput& input) {
  if (!twin.levels[0].system.effects.empty()) return false;
  for (const auto* recordings : {&input.data.recordings, &input.judged}) {
    for (const Recording& recording : *recordings) {
      if (twin.TrainingOn(recording.hash)) return false;
    }
  }
  return true;
}

DiagnosisRecordings CheckAndChoose(const Twin& twin, DiagnosisInput* input) {
  for (auto* recordings : {&input->data.recordings, &input->judged, &input->before}) {
    for (Recording& recording : *recordings) {
      ExpectLastingGrasps(recording);
      WarnOfOddNumbering(twin, recording.name, &recording);
    }
  }
  return ChooseRecordings(input->data, input->judged, input->before);
}

std::vector<std::string> WarningsOf(const Twin& twin, const DiagnosisRecordings& recordings) {
  if (twin.force_scale) return {};  // it was weighed by forces
  constexpr double kAlike = 0.01;   // masses are alike that differ by this part of the twin's
  const double mass = twin.levels[0].system.mass.sum();
  std::vector<std::string> warnings;
  for (const auto* list : {&recordings.fit, &recordings.held_out}) {
    for (const Recording& recording : *list) {
      if (std::abs(recording.mass - mass) <= kAlike * mass) continue;
      warnings.push_back(fmt::format(
          "recording {}: says that the object weighs {:.4g} kg; the twin's {:.4g} kg are taken",
          recording.name, recording.mass, mass));
    }
  }
  return warnings;
}

std::vector<std::string> WarningsOf(const Diagnosis& diagnosis) {
  std::vector<std::string> warnings;
  // it lacks what is not in the list of effects, or it is not of this object
  if (diagnosis.after.held > diagnosis.motionless) {
    warnings.push_back(fmt::format(
        "the twin predicts worse than a body that does not move ({:.4g} m against {:.4g} m): are "
        "the recordings of its object, in metres, with points in its order?",
        diagnosis.after.held, diagnosis.motionless));
  }
  if (!diagnosis.effects.empty() && diagnosis.twin.levels.size() > 1) {  // only level 0 is fitted
    warnings.emplace_back(
        "coarse levels have the effects, but are not fitted with them: physpring train --effects "
        "fits a hierarchy");
  }
  return warnings;
}

}  // namespace physpring

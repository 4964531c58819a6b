// SPDX-License-Identifier: Apache-2.0
// The closed loop: what does a twin get wrong on recordings of its object, and which effect that
// its model lacks is the cause?
//   1  noise    from the measurements alone (noise_floor.h)
//   2  refit    of the model without any new effect, on the fit frames
//   3  trace    of every effect: how much a linearised fit with its parameters added would lower
//               the misfit, from each of its starts
//   4  refit    of the best few effects, each together with the model's own parameters
//   5  choose   the one that is best on frames not fitted; accept it if it beats the refit without
//               it by more than chance (paired block bootstrap) and by more than a small part
//   6  repeat from 3, until nothing is accepted
// A twin that was trained on one of the recordings has bent its single springs to what its model
// lacks: they start again from equal ones, and are fitted at the end of 2 and 4. A twin that was
// trained on others knows its object: then its own parameters hardly move.
#ifndef PHYSPRING_TRAINER_DIAGNOSIS_DIAGNOSIS_H_
#define PHYSPRING_TRAINER_DIAGNOSIS_DIAGNOSIS_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "trainer/diagnosis/block_bootstrap.h"
#include "trainer/diagnosis/effect_problem.h"
#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

struct DiagnosisOptions {
  int threads = 1;
  std::uint64_t seed = 0;
  int most_effects = 3;       // accepted
  double false_alarm = 0.05;  // rate at which a model that lacks nothing gets an effect
  double least_gain = 0.15;   // part of the error above the noise floor that an effect must explain
  std::function<void(double share, const std::string& status)> progress;  // may throw to stop
};

// Mean track errors, m; NaN where there are no such frames.
struct TrackPair {
  double fit, held;
};

struct EffectCandidate {
  std::string name;
  double score = 0;                // part of the squared misfit that the linearised fit takes away
  std::optional<TrackPair> refit;  // of the best few
  BootstrapResult gain;            // on held-out frames against the refit without it
  EffectValues values;             // refitted
};

// What no effect explains, if the error on held-out frames stays well above the noise floor.
struct Unexplained {
  double track = 0;                      // error left above the noise floor, m
  int point = 0;                         // where it is largest ...
  Eigen::Vector3d position;              // ... its place in the reference configuration, m
  double first_time = 0, last_time = 0;  // when most of it is seen, s
  Eigen::Vector3d direction;             // mean direction of measured minus predicted there
};

struct Diagnosis {
  bool trained_on = false;  // the twin was trained on one of the recordings
  double noise_floor = 0;   // track error of a perfect model, m
  TrackPair before{}, after{};
  BootstrapResult gain;  // of all accepted effects together, on held-out frames
  std::vector<EffectValues> effects;
  std::vector<EffectCandidate> candidates;  // of the first round, best first
  std::optional<Unexplained> unexplained;
  FrameTrack before_track, after_track;  // on held-out frames
  Twin twin;                             // refitted, with the effects
};

// `held_out` may be empty: then the future frames of the recordings are held out, or blocks of
// frames where a recording has no future. Throws Error if a recording is not of the twin's object,
// or the twin cannot be simulated.
Diagnosis Diagnose(const Twin& twin, const std::vector<Recording>& recordings,
                   const std::vector<Recording>& held_out, const DiagnosisOptions& options);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_DIAGNOSIS_DIAGNOSIS_H_

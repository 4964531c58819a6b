// SPDX-License-Identifier: Apache-2.0
// The closed loop: what does a twin get wrong on recordings of its object, and which effect that
// its model lacks is the cause?
//   1  noise    from the measurements alone (noise_floor.h)
//   2  refit    of the model without any new effect, on the fit frames: the best of the bodies that
//               come into question (diagnosis_body.h), as a smooth one
//   3  trace    of every effect: how much a linearised fit with its parameters added would lower
//               the misfit, from each of its starts (effect_trace.h)
//   4  search   of the best effects by refits of body and effect together, under an observer that
//               lets go (effect_search.h)
//   5  choose   the one that is best on frames not fitted, or a simpler one that is as good; it is
//               accepted if it beats the refit without it by more than chance (paired block
//               bootstrap) and by more than a small part
//   6  repeat from 3, until nothing is accepted; where another effect was about as good,
//               beside that, too: what is added next tells which of them it is
//   7  law     if much is left, terms of a law that is not in the list of effects (law_search.h)
//   8  tell    the forces that are still missing, before and after (residual_force.h)
//   9  end     where frames were held out, and no recordings: what was found is fitted to these
//               frames, too (last_fit.h)
#ifndef PHYSPRING_DIAGNOSIS_DIAGNOSIS_H_
#define PHYSPRING_DIAGNOSIS_DIAGNOSIS_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/acceptance.h"
#include "diagnosis/block_bootstrap.h"
#include "diagnosis/diagnosis_recordings.h"
#include "diagnosis/effect_certainty.h"
#include "diagnosis/fitting.h"
#include "diagnosis/residual_pattern.h"
#include "diagnosis/unexplained.h"
#include "trainer/data/episode.h"
#include "trainer/journal/journal.h"
#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

struct DiagnosisOptions {
  int threads = 1;
  std::uint64_t seed = 0;
  int most_effects = 3;       // so many are accepted at most; at least 1
  double false_alarm = 0.05;  // rate at which a model that lacks nothing gets an effect
  // What an effect must explain at least (acceptance.h).
  double least_gain = 0.6, least_noise = 0.3;
  // Holds what is worked out already, and keeps more of it. Its `progress` is called in between.
  Journal* journal = nullptr;
};

struct EffectCandidate {
  std::string name;
  double score = 0;                // part of the squared misfit that the linearised fit takes away
  std::optional<TrackPair> refit;  // only the best few are refitted
  double without = 0;              // error of the refit without it on held-out frames, m
  BootstrapResult gain;            // the gain over that
  EffectValues values;             // the refitted values
  bool alike = false;              // as good as the effect that was chosen, by one standard error
};

// All effects in one round of the loop: first those that were refitted, by their error, then the
// others, by their trace.
using EffectRanking = std::vector<EffectCandidate>;

struct Diagnosis {
  std::vector<std::string> fitted, judged;  // names of recordings; none judged: frames are held out
  std::vector<std::string> before_change;   // names of those of the object before it changed
  int resting_frames = 0;                   // frames at rest that are left out (split_recording.h)
  bool trained_on = false;                  // the twin was trained on one of the recordings
  double noise_floor = 0;                   // track error of a perfect model, m
  double motionless = 0;                    // track error on held-out frames if nothing moved, m
  TrackPair before{}, after{};
  BootstrapResult gain;  // the gain of all accepted effects together, on held-out frames
  std::vector<EffectValues> effects;
  int law_terms = 0;  // so many of the last ones are terms of a law that is not in the list
  // One for each value of `effects`, one effect after the other.
  std::vector<ValueCertainty> certainty;
  std::vector<EffectRanking> rankings;  // one for each round; i effects are accepted before round i
  std::string refusal;  // "EFFECT: why it helps too little to be added"; empty: none was left over
  std::optional<Unexplained> unexplained;
  FrameTrack before_track, after_track;  // track errors on held-out frames
  // Forces that the model lacks on the first recording, without and with the effects.
  ResidualPattern residual_before, residual_after;
  // The twin, refitted with the effects, and its track error on all frames where step 9 was made.
  // All else but the values of `effects` is of the fit before that step.
  Twin twin;
  std::optional<double> all_frames;
  // The fits that the errors before and after are of, as twins: to show their motion.
  Twin fit_before, fit_after;
  // How the frames of each recording were used: of those fitted, then of those that judged.
  std::vector<std::vector<FrameUse>> uses;
};

// Where no recordings are held out, the future frames of those to fit are, or blocks of frames
// where a recording has no future. Throws Error if a recording is not of the twin's object, no
// frame is left to fit or to judge by, or the twin cannot be simulated.
Diagnosis Diagnose(const Twin& twin, const DiagnosisRecordings& recordings,
                   const DiagnosisOptions& options);

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_DIAGNOSIS_H_

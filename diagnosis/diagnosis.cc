// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/diagnosis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/effect_problem.h"
#include "diagnosis/find_effects.h"
#include "diagnosis/fit_residual.h"
#include "diagnosis/last_fit.h"
#include "diagnosis/noise_floor.h"
#include "diagnosis/trained_fit.h"
#include "twin/error.h"
#include "twin/predict.h"

namespace physpring {
namespace {

using Use = SplitRecording::Use;

constexpr int kFewestFitted = 8, kFewestJudged = 5;  // frames in which points are seen
// Shares of the work, as the journal tells it: the loop over effects, the residual forces, the last
// fit.
constexpr WorkShare kLoopShare{0, 0.94}, kResidualShare{0.94, 0.96}, kLastShare{0.96, 1};

// In the order fitted, held out, before the change.
std::vector<SplitRecording> SplitAll(const DiagnosisRecordings& recordings) {
  std::vector<SplitRecording> splits;
  const bool frames_judge = recordings.held_out.empty();
  for (const Recording& recording : recordings.fit) {
    splits.push_back(frames_judge ? HoldOutFrames(recording) : UseAll(recording, Use::kFit));
  }
  for (const Recording& r : recordings.held_out) splits.push_back(UseAll(r, Use::kHeld));
  for (const Recording& recording : recordings.before) {
    splits.push_back(UseAll(recording, Use::kFit));
    splits.back().before_change = true;
  }
  return splits;
}

// There must be frames to fit effects to, and others to judge them by.
void ExpectSplit(const std::vector<SplitRecording>& splits) {
  struct Wanted {
    Use use;
    int fewest;
    const char* purpose;
  };
  for (const Wanted& wanted :
       {Wanted{Use::kFit, kFewestFitted, "fit"}, Wanted{Use::kHeld, kFewestJudged, "judge by"}}) {
    int seen = 0;
    std::string name;  // the name of the first recording with this use
    for (const SplitRecording& split : splits) {
      seen += split.seen(wanted.use);
      if (name.empty() && split.last(wanted.use) > 0) name = split.recording->name;
    }
    if (seen >= wanted.fewest) continue;
    throw Error(fmt::format(
        "recording {}: its points are seen in {} of the frames to {}, {} are the fewest",
        name.empty() ? splits[0].recording->name : name, seen, wanted.purpose, wanted.fewest));
  }
}

// What is left to explain is told in units of the noise, so there must be some.
double NoiseOf(const std::vector<SplitRecording>& splits) {
  std::vector<const Recording*> all;
  for (const SplitRecording& split : splits) all.push_back(split.recording);
  const double noise = MeasurementNoise(all);
  if (noise > 0) return noise;
  throw Error(fmt::format(
      "recording {}: {}", splits[0].recording->name,
      std::isnan(noise)
          ? "none of its points is seen in five frames in a row, so its noise cannot be measured"
          : "its points neither move nor have any noise, so there is nothing to diagnose"));
}

// Mean track error of the held-out frames if nothing moved.
double MotionlessTrack(const std::vector<SplitRecording>& splits) {
  std::vector<std::vector<Points>> still;
  for (const SplitRecording& split : splits) {
    still.emplace_back(split.use.size(), split.recording->start);
  }
  return Mean(TrackOf(splits, still, Use::kHeld));
}

// Whether training has seen none of the frames that are held out.
bool HasNotSeenHeldOut(const Twin& twin, const DiagnosisRecordings& recordings) {
  const std::vector<Recording>& held_out = recordings.held_out;
  if (!held_out.empty()) {
    return std::none_of(held_out.begin(), held_out.end(),
                        [&](const Recording& r) { return twin.TrainingOn(r.hash); });
  }
  return std::all_of(recordings.fit.begin(), recordings.fit.end(),
                     [](const Recording& r) { return r.train_frames < r.frame_count(); });
}

// The verdict's effects behind those that were known.
std::vector<EffectValues> NewEffects(const Verdict& verdict,
                                     const std::vector<EffectValues>& known) {
  const std::vector<EffectValues>& all = verdict.system.effects;
  return {all.begin() + static_cast<long>(known.size()), all.end()};
}

// The twin with the verdict's system at level 0, and its effects at all levels, behind the `own`
// effects that belong to the body.
Twin TwinWith(Twin twin, const Verdict& verdict, std::size_t own,
              const std::vector<SplitRecording>& splits) {
  twin.training_state.clear();
  twin.material.reset();  // they are of level 0 as it was
  twin.fit_errors.reset();
  twin.posterior = {};
  const auto first = verdict.system.effects.begin() + static_cast<long>(own);
  for (TwinLevel& level : twin.levels) {
    std::vector<EffectValues>& effects = level.system.effects;
    effects.resize(std::min(own, effects.size()));
    effects.insert(effects.end(), first, verdict.system.effects.end());
  }
  TwinLevel& dense = twin.levels[0];
  dense.system = verdict.system;
  dense.substeps_per_second = DiagnosisRate(dense.system, twin.fps);
  twin.controller_velocity = verdict.controller_velocity;
  for (const SplitRecording& split : splits) {
    const Recording& recording = *split.recording;
    const int fitted = split.last(Use::kFit);
    if (fitted == 0) continue;
    const TrainedOn* known = twin.TrainingOn(recording.hash);
    if (!known) {
      twin.trained_on.push_back({recording.name, recording.hash, fitted});
    } else {
      int& frames =
          twin.trained_on[static_cast<std::size_t>(known - twin.trained_on.data())].train_frames;
      frames = std::max(frames, fitted);
    }
  }
  return twin;
}

// A diagnosis that says only what it is about. Throws Error if a recording is of another object.
Diagnosis Introduce(const Twin& twin, const DiagnosisRecordings& recordings) {
  Diagnosis result;
  for (const Recording& recording : recordings.fit) {
    ExpectSameObject(twin, recording);
    result.trained_on |= twin.TrainingOn(recording.hash) != nullptr;
    result.fitted.push_back(recording.name);
  }
  for (const Recording& recording : recordings.held_out) {
    ExpectSameObject(twin, recording);
    result.judged.push_back(recording.name);
  }
  for (const Recording& recording : recordings.before) {
    ExpectSameObject(twin, recording);
    result.before_change.push_back(recording.name);
  }
  return result;
}

// Tells what the findings say of held-out frames, and the effects with their certainty.
void Tell(const Fitting& fitting, const Findings& findings, const std::vector<EffectValues>& known,
          Diagnosis* result) {
  const Verdict &before = findings.before, &accepted = findings.accepted;
  result->before = before.track;
  result->before_track = before.held;
  result->rankings = findings.rankings;
  result->refusal = findings.refusal;
  result->after = accepted.track;
  result->after_track = accepted.held;
  result->gain = findings.gain;
  result->effects = NewEffects(accepted, known);
  result->law_terms = findings.law_terms;
  if (result->effects.empty()) return;
  result->certainty = CertaintyOf(fitting, findings.accepted.descent);
  result->certainty.erase(result->certainty.begin(),
                          result->certainty.end() - EffectValueCount(result->effects));
}

// Tells the forces that are missing without and with the effects, and what they say of what is
// left.
void TellResidual(const Fitting& fitting, const Findings& findings, double noise,
                  Diagnosis* result) {
  std::vector<const Verdict*> verdicts{&findings.before};
  if (!result->effects.empty()) verdicts.push_back(&findings.accepted);
  const auto residuals = ResidualsOf(fitting, verdicts, noise, kResidualShare);
  result->residual_before = residuals.front();
  result->residual_after = residuals.back();
  const double error = findings.accepted.track.held;
  if (IsUnexplained(error, result->noise_floor)) {
    result->unexplained = FindUnexplained(result->residual_after, error - result->noise_floor,
                                          fitting.recordings()[0].recording->fps);
  }
}

// The fits whose errors are told, and the frames that they are of.
void KeepFits(const Twin& twin, const Findings& findings, std::size_t own,
              const std::vector<SplitRecording>& splits, Diagnosis* result) {
  result->fit_before = TwinWith(twin, findings.before, own, splits);
  result->fit_after = TwinWith(twin, findings.accepted, own, splits);
  for (const SplitRecording& split : splits) result->uses.push_back(split.use);
}

}  // namespace

Diagnosis Diagnose(const Twin& twin, const DiagnosisRecordings& recordings,
                   const DiagnosisOptions& options) {
  Diagnosis result = Introduce(twin, recordings);
  std::vector<SplitRecording> splits = SplitAll(recordings);
  ExpectSplit(splits);
  const double noise = NoiseOf(splits);
  for (SplitRecording& split : splits) result.resting_frames += LeaveOutRest(noise, &split);
  result.noise_floor = TrackNoiseFloor(noise);
  result.motionless = MotionlessTrack(splits);
  // `own` are the effects of the body itself, if it has any; `known` are those of the twin so far
  const std::vector<EffectValues>& known = twin.levels[0].system.effects;
  const Fitting fitting(BodiesOf(twin, recordings.fit[0], result.trained_on), splits,
                        options.threads, options.journal, known.size());
  const std::vector<EffectValues>& own = fitting.bodies()[0].base.effects;
  std::optional<Verdict> trained;  // training took more care than a refit of springs does
  if (result.trained_on && HasNotSeenHeldOut(twin, recordings)) {
    trained = JudgeTwin(twin, splits);
  }
  const auto findings = FindEffects(fitting, result.noise_floor, options, kLoopShare,
                                    own.empty() ? known : std::vector<EffectValues>(), trained);
  if (!findings) {
    throw Error(fmt::format("recording {}: twin {} diverges, so there is nothing to diagnose",
                            recordings.fit[0].name, twin.name));
  }
  Tell(fitting, *findings, known, &result);
  TellResidual(fitting, *findings, noise, &result);
  KeepFits(twin, *findings, own.size(), splits, &result);
  std::optional<Verdict> last;
  if (recordings.held_out.empty() && !result.effects.empty()) {
    last = FitAllFrames(fitting, kLastShare, findings->accepted);
  }
  if (last) {
    result.all_frames = last->track.fit;
    result.effects = NewEffects(*last, known);
    for (SplitRecording& split : splits) split = FitHeldOut(split);
  }
  result.twin = TwinWith(twin, last ? *last : findings->accepted, own.size(), splits);
  return result;
}

}  // namespace physpring

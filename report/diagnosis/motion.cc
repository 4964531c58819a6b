// SPDX-License-Identifier: Apache-2.0
#include "report/diagnosis/motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "report/diagnosis/effect_words.h"
#include "report/picture/escape.h"
#include "report/picture/film_data.h"
#include "report/picture/film_section.h"
#include "report/picture/plot.h"
#include "twin/effects/body_coordinate.h"
#include "twin/error.h"
#include "twin/metrics.h"
#include "twin/predict.h"

namespace physpring {
namespace {

constexpr std::size_t kMostOfAKind = 2;  // recordings that judged, or that were fitted

std::vector<double> TrackErrors(const Recording& recording, const std::vector<Points>& motion) {
  std::vector<int> nodes(static_cast<std::size_t>(recording.point_count()));
  std::iota(nodes.begin(), nodes.end(), 0);
  std::vector<double> errors;
  for (std::size_t t = 0; t < motion.size(); ++t) {
    errors.push_back(TrackError(recording.points[t], motion[t], nodes));
  }
  return errors;
}

// Adds nothing if the motion cannot be predicted.
void AddMotion(const Diagnosis& diagnosis, const Recording& recording,
               const std::vector<FrameUse>& uses, std::vector<ShownMotion>* motions) {
  ShownMotion motion{&recording, &uses, {}, {}, {}, {}};
  try {
    motion.before = Predict(diagnosis.fit_before, 0, recording, {});
    if (!diagnosis.effects.empty()) {
      motion.after = Predict(diagnosis.fit_after, 0, recording, {});
    }
  } catch (const Error&) {
    return;
  }
  motion.before_error = TrackErrors(recording, motion.before);
  motion.after_error = TrackErrors(recording, motion.after);
  motions->push_back(std::move(motion));
}

const char* NameOf(FrameUse use) {
  switch (use) {
    case FrameUse::kFit:
      return "fitted";
    case FrameUse::kHeld:
      return "held back";
    case FrameUse::kNone:
      break;
  }
  return "not used";
}

// Calls visit(use, first, last + 1) for each run of frames of one use.
template <class Visit>
void ForEachRun(const std::vector<FrameUse>& uses, Visit visit) {
  for (std::size_t first = 0; first < uses.size();) {
    std::size_t next = first;
    while (next < uses.size() && uses[next] == uses[first]) ++next;
    visit(uses[first], static_cast<int>(first), static_cast<int>(next));
    first = next;
  }
}

// Where the film begins: at the largest error without the effects.
int WorstFrame(const ShownMotion& motion) {
  int worst = 0;
  double largest = 0;
  for (std::size_t t = 0; t < motion.before_error.size(); ++t) {
    if (!(motion.before_error[t] > largest)) continue;
    largest = motion.before_error[t];
    worst = static_cast<int>(t);
  }
  return worst;
}

// The places at which effects act, on the last layer.
std::vector<FilmMark> MarksOf(const Diagnosis& diagnosis) {
  std::vector<FilmMark> marks;
  for (const EffectValues& effect : diagnosis.effects) {
    for (const EffectPicture::Place& place : PictureOf(diagnosis, effect).places) {
      Eigen::Index node = 0;
      PatchWeights(diagnosis.twin.levels[0].system, place.place).maxCoeff(&node);
      marks.push_back({1, static_cast<int>(node), place.anchor});
    }
  }
  return marks;
}

FilmRecording FilmOf(const Diagnosis& diagnosis, const ShownMotion& motion) {
  FilmRecording film{motion.recording, {}, {}, WorstFrame(motion), MarksOf(diagnosis)};
  film.layers.push_back({&diagnosis.fit_before.levels[0].system, &motion.before, nullptr});
  if (!motion.after.empty()) {
    film.layers.push_back({&diagnosis.fit_after.levels[0].system, &motion.after, nullptr});
  }
  ForEachRun(*motion.uses, [&](FrameUse use, int first, int) {
    film.spans.push_back({first, first == 0 ? "start" : NameOf(use), use == FrameUse::kFit});
  });
  return film;
}

std::string FormatMotionError(const Diagnosis& diagnosis, const ShownMotion& motion) {
  const double fps = motion.recording->fps;
  Plot plot{"Track error over time", "time, s", "track error, mm", {}, {}, {}};
  plot.width = 760;
  plot.height = 240;
  plot.cursor = true;
  plot.curves.push_back(SeriesCurve(motion.before_error, 1 / fps, 0, 1e3, "before"));
  if (!motion.after.empty()) {
    plot.curves.push_back(SeriesCurve(motion.after_error, 1 / fps, 0, 1e3, "after"));
  }
  plot.lines.push_back({1e3 * diagnosis.noise_floor, "noise"});
  ForEachRun(*motion.uses, [&](FrameUse use, int first, int next) {
    if (use == FrameUse::kHeld) plot.shaded.push_back({(first - 0.5) / fps, (next - 0.5) / fps});
  });
  return FormatPlot(plot);
}

}  // namespace

std::vector<ShownMotion> PredictMotions(const Diagnosis& diagnosis,
                                        const DiagnosisRecordings& recordings) {
  const std::size_t fitted = recordings.fit.size();
  std::vector<ShownMotion> motions;
  for (std::size_t i = 0; i < std::min(kMostOfAKind, recordings.held_out.size()); ++i) {
    AddMotion(diagnosis, recordings.held_out[i], diagnosis.uses[fitted + i], &motions);
  }
  for (std::size_t i = 0; i < std::min(kMostOfAKind, fitted); ++i) {
    AddMotion(diagnosis, recordings.fit[i], diagnosis.uses[i], &motions);
  }
  return motions;
}

std::string FormatMotionFilm(const Diagnosis& diagnosis, const std::vector<ShownMotion>& motions) {
  if (motions.empty()) return "";
  FilmSection film;
  for (const ShownMotion& motion : motions) film.recordings.push_back(motion.recording->name);
  if (diagnosis.effects.empty()) {
    film.captions = {"the twin, refitted"};
  } else {
    std::string names;
    for (const EffectValues& effect : diagnosis.effects) {
      names += (names.empty() ? "" : ", ") + SpacedName(effect.name);
    }
    film.captions = {"before: without it", "after: with " + names};
  }
  return FormatFilmSection(film);
}

std::string FormatMotionData(const Diagnosis& diagnosis, const std::vector<ShownMotion>& motions) {
  std::vector<FilmRecording> films;
  std::vector<View> views;
  for (const ShownMotion& motion : motions) {
    films.push_back(FilmOf(diagnosis, motion));
    views.emplace_back(*motion.recording);
  }
  return FormatFilmData(films, views);
}

std::string FormatMotionErrors(const Diagnosis& diagnosis,
                               const std::vector<ShownMotion>& motions) {
  std::string html;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    html +=
        fmt::format("<section data-recording=\"{}\"><h3>{}</h3>\n{}</section>\n", i,
                    Escape(motions[i].recording->name), FormatMotionError(diagnosis, motions[i]));
  }
  if (html.empty()) return html;
  const std::string after = diagnosis.effects.empty() ? "" : " <i class=\"key after\"></i>after";
  return "<h2>Error over time</h2>\n<p class=\"note\"><i class=\"key before\"></i>before" + after +
         " <i class=\"key noise\"></i>noise alone. Shaded: held back, not fitted. The error is the "
         "mean distance between measured points and where they were predicted from the start "
         "on.</p>\n" +
         html;
}

}  // namespace physpring

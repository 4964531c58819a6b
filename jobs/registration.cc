// SPDX-License-Identifier: Apache-2.0
#include "jobs/registration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "exporter/mesh_place.h"
#include "exporter/mesh_samples.h"
#include "registration/cloud_particles.h"
#include "registration/refine_names.h"
#include "registration/register_clouds.h"
#include "trainer/data/fit_data.h"
#include "trainer/fits/train.h"
#include "twin/error.h"
#include "twin/predict.h"
#include "twin/stop_request.h"

namespace physpring {
namespace {

RegisteredClouds RegisterOnShape(const Recording& clouds, const RegistrationOptions& options,
                                 std::vector<std::string>* warnings) {
  constexpr int kSamples = 16;  // of the mesh, by the points to make
  ExpectSeen(clouds, 1);
  const PlacedMesh placed = ReadMeshAt(options.shape, PointsOf(clouds.surface[0]));
  *warnings = placed.warnings;
  const Points samples =
      SampleSurface(placed.mesh, kSamples * std::max(options.points, kMostMadePoints));
  return RegisterCloudsOn(clouds, samples, options.points, options.threads);
}

void AddDoubts(const RegisteredClouds& registered, std::vector<std::string>* warnings) {
  if (const auto& lost = registered.lost) {
    const bool to_the_end = lost->last + 1 == registered.recording.frame_count();
    warnings->push_back(
        fmt::format("it is lost {}: the clouds are not where the points are",
                    to_the_end ? fmt::format("from frame {} on", lost->first)
                               : fmt::format("in frames {} to {}", lost->first, lost->last)));
  }
  if (std::isnan(registered.fit.distance)) warnings->emplace_back("the last second has no cloud");
  if (registered.outliers > 0) {
    warnings->push_back(
        fmt::format("{} points of the first cloud are far from all others, and were left out",
                    registered.outliers));
  }
}

// The motion that a twin predicts which is fitted to the recording.
std::vector<Points> FitAndPredictWith(const Recording& recording, int round, int threads,
                                      const TellProgress& progress) {
  Journal journal;
  journal.progress = [&](double done, const std::string& status) {
    StopIfRequested();
    progress((round + done) / kMostNamingRounds,
             fmt::format("fit {} to {} frames, {}", round + 1, recording.train_frames, status));
  };
  const FitData data = CollectFitData({{recording.name}}, {AsReadBack(recording)});
  TrainOptions options;
  options.threads = threads;
  const Twin twin = Train(data, options, {}, Work(&journal, PieceKey("names")));
  return Predict(twin, 0, ByClockOf(twin, data).recordings[0], {});
}

void Refine(int threads, const TellProgress& progress, CloudRegistration* registration) {
  const RefinedNames refined =
      RefineNames(registration->clouds, [&](const Recording& recording, int round) {
        return FitAndPredictWith(recording, round, threads, progress);
      });
  registration->clouds = refined.registered;
  const int frames = refined.registered.recording.train_frames;
  registration->refined = fmt::format(
      "named anew by {} {}; the last one explains {} of the {} frames that are for fitting",
      refined.fits, refined.fits == 1 ? "fit" : "fits", refined.explained, frames);
  if (refined.explained < frames) {
    registration->warnings.push_back(
        fmt::format("from frame {} on no fit explains the clouds: names may be wrong there",
                    refined.explained));
  }
}

}  // namespace

void ExpectClouds(const Recording& recording, const std::string& path) {
  if (recording.point_count() == 0) return;
  throw Error(path + ": has 'points' already; without them, points are made of its clouds");
}

CloudRegistration RegisterAsAsked(const Recording& clouds, const RegistrationOptions& options,
                                  const TellProgress& progress) {
  CloudRegistration registration;
  if (!options.shape.empty()) {
    registration.clouds = RegisterOnShape(clouds, options, &registration.warnings);
  } else if (options.like) {
    registration.clouds = RegisterCloudsLike(clouds, *options.like, options.threads);
  } else {
    registration.clouds = RegisterClouds(clouds, options.points, options.threads);
  }
  if (options.refine && registration.clouds.lost) {
    registration.warnings.emplace_back("not refined: a fit to points that are lost tells nothing");
  } else if (options.refine) {
    Refine(options.threads, progress, &registration);
  }
  const int made = registration.clouds.recording.point_count();
  if (made < options.points) {
    registration.warnings.push_back(
        fmt::format("{} points are made: the first clouds show no more places", made));
  }
  AddDoubts(registration.clouds, &registration.warnings);
  return registration;
}

std::vector<std::string> WarningsOf(const RegisteredMarkers& registered) {
  constexpr double kConfused = 0.05, kOthers = 0.5;
  std::vector<std::string> warnings;
  if (registered.lost_from) {
    warnings.push_back(fmt::format(
        "they are lost: from frame {} on hardly any marker is found; do they move further than "
        "{:.0f} mm in a frame, or are all hidden for a while?",
        *registered.lost_from, 500 * registered.spacing));
  } else if (registered.confused > kConfused) {
    warnings.push_back(fmt::format(
        "{:.0f} % of the markers are not found in frames that have points without a name instead: "
        "names may be wrong",
        100 * registered.confused));
  }
  if (registered.without_name > kOthers) {
    warnings.push_back(
        fmt::format("{:.2g} points of a frame, on the average, are no marker that is followed",
                    registered.without_name));
  }
  return warnings;
}

}  // namespace physpring

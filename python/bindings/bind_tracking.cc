// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/optional.h>

#include <cmath>
#include <optional>

#include "jobs/tracking.h"
#include "python/bindings/arrays.h"
#include "python/bindings/watched_work.h"
#include "tracker/track_recording.h"
#include "twin/predict.h"
#include "twin/regrasp.h"

namespace physpring {
namespace {

nb::dict Track(const GivenTwin& twin, const GivenRecording& given, bool cloud, double hide,
               std::uint64_t seed, std::optional<int> substeps) {
  const TrackOptions options{cloud, hide, seed, substeps.value_or(0)};
  Recording recording = RecordingToTrack(Checked(twin), given.recording, options);
  ExpectSameObject(twin.twin, recording);
  const Twin held = HeldAsIn(&recording, twin.twin);
  TrackedMotion motion;
  RunWatched(nb::none(),
             [&](const TellShare& /*tell*/) { motion = TrackRecording(held, recording, options); });
  nb::dict result;
  result["position"] = CopyOf(motion.position);
  result["velocity"] = CopyOf(motion.velocity);
  result["hidden"] = CopyOf(motion.hidden);
  result["error"] = motion.errors.tracked;
  result["error_predicted"] = motion.errors.predicted;
  result["error_interpolated"] = motion.errors.interpolated;
  result["cloud_distance"] = motion.cloud ? motion.cloud->distance : std::nan("");
  result["frames_per_second"] = motion.frames_per_second;
  Warn(WarningsOf(motion));
  return result;
}

}  // namespace

void BindTracking(nb::module_& module) {
  module.def("track", &Track, nb::arg("twin"), nb::arg("recording"), nb::arg("cloud"),
             nb::arg("hide"), nb::arg("seed"), nb::arg("substeps"));
}

}  // namespace physpring

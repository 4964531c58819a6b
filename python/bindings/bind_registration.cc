// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "jobs/interior.h"
#include "jobs/registration.h"
#include "python/bindings/given_recordings.h"
#include "python/bindings/watched_work.h"
#include "registration/placed_twin.h"
#include "registration/register_markers.h"
#include "twin/split_objects.h"

namespace physpring {
namespace {

namespace nb = nanobind;

GivenRecording Registered(const GivenRecording& clouds, const Recording& recording,
                          const std::vector<std::string>& warnings) {
  GivenRecording given = InMemory(clouds.recording.name, StoreRecording(recording));
  Warn(warnings);
  return given;
}

GivenRecording RegisterClouds(const GivenRecording& clouds, RegistrationOptions options,
                              const GivenRecording* like, const GivenTwin* like_twin,
                              const nb::object& callback) {
  ExpectClouds(clouds.recording, clouds.entry.path);
  if (like) {
    ExpectPoints(like->recording, like->entry.path);
    options.like = like->recording;
  }
  if (like_twin) options.like = ReferenceOf(Checked(*like_twin));
  CloudRegistration registration;
  RunWatched(callback, [&](const TellShare& tell) {
    registration = RegisterAsAsked(clouds.recording, options, tell);
    tell(1, registration.refined);
  });
  return Registered(clouds, registration.clouds.recording, registration.warnings);
}

GivenRecording RegisterMarkersOf(const GivenRecording& clouds, bool rod) {
  ExpectClouds(clouds.recording, clouds.entry.path);
  RegisteredMarkers registered;
  RunWatched(nb::none(), [&](const TellShare& /*tell*/) {
    registered = RegisterMarkers(clouds.recording, rod);
  });
  return Registered(clouds, registered.recording, WarningsOf(registered));
}

GivenRecording FilledInterior(const GivenRecording& given, const std::string& mesh, double spacing,
                              bool surface) {
  FilledRecording filled;
  RunWatched(nb::none(), [&](const TellShare& /*tell*/) {
    filled = FillInterior(given.recording, given.entry.path, {mesh, spacing, surface});
  });
  return Registered(given, filled.recording, filled.warnings);
}

std::vector<GivenRecording> Split(const GivenRecording& given) {
  const std::vector<Recording> parts = SplitObjects(given.recording);
  if (parts.size() == 1) return {given};
  std::vector<GivenRecording> split;
  for (const Recording& part : parts) split.push_back(InMemory(part.name, StoreRecording(part)));
  return split;
}

}  // namespace

void BindRegistration(nb::module_& module) {
  module.def(
      "register_clouds",
      [](const GivenRecording& clouds, int points, const std::string& shape, bool refine,
         int threads, const GivenRecording* like, const GivenTwin* like_twin,
         const nb::object& callback) {
        RegistrationOptions options{.points = points, .shape = shape};
        options.refine = refine;
        options.threads = threads;
        return RegisterClouds(clouds, options, like, like_twin, callback);
      },
      nb::arg("clouds"), nb::arg("points"), nb::arg("shape"), nb::arg("refine"), nb::arg("threads"),
      nb::arg("like").none(), nb::arg("like_twin").none(), nb::arg("callback").none());
  module.def("interior", &FilledInterior, nb::arg("recording"), nb::arg("mesh"), nb::arg("spacing"),
             nb::arg("surface"));
  module.def("split", &Split, nb::arg("recording"));
  module.def("register_markers", &RegisterMarkersOf, nb::arg("clouds"), nb::arg("rod"));
}

}  // namespace physpring

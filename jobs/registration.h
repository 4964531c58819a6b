// SPDX-License-Identifier: Apache-2.0
// Clouds of points without names -> a recording of points that are followed, as it is asked for,
// and what is to say of it.
#ifndef PHYSPRING_JOBS_REGISTRATION_H_
#define PHYSPRING_JOBS_REGISTRATION_H_

#include <optional>
#include <string>
#include <vector>

#include "jobs/training.h"
#include "registration/register_markers.h"
#include "registration/told_points.h"
#include "twin/recording.h"

namespace physpring {

// At most one of `shape` and `like` is given, and `points` not with `like`.
struct RegistrationOptions {
  int points = 0;                 // to make; 0: as many as the clouds ask for
  std::string shape;              // file of the object's surface in frame 0; empty: not known
  std::optional<Recording> like;  // whose points are taken
  bool refine = false;            // name the points anew by fits
  int threads = 1;                // at most; the result does not depend on it
};

struct CloudRegistration {
  RegisteredClouds clouds;
  std::string refined;  // what `refine` came to, one line; empty: it was not done
  std::vector<std::string> warnings;
};

// Throws Error unless the recording has clouds and no points.
void ExpectClouds(const Recording& recording, const std::string& path);

// Throws Error as the functions of registration/register_clouds.h do, and for a shape that is no
// mesh; Stopped where a fit is asked to stop.
CloudRegistration RegisterAsAsked(const Recording& clouds, const RegistrationOptions& options,
                                  const TellProgress& progress);

std::vector<std::string> WarningsOf(const RegisteredMarkers& registered);

}  // namespace physpring

#endif  // PHYSPRING_JOBS_REGISTRATION_H_

// SPDX-License-Identifier: Apache-2.0
#include "registration/followed_body.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "registration/cloud_particles.h"
#include "tracker/track_recording.h"
#include "tracker/tracker_bank.h"
#include "trainer/bodies/start_system.h"
#include "twin/error.h"
#include "twin/local_motion.h"
#include "twin/neighbours.h"
#include "twin/parallel.h"
#include "twin/recorded_input.h"
#include "twin/rotation.h"
#include "twin/stability.h"
#include "twin/stop_request.h"

namespace physpring {
namespace {

// A frame. Fewer make a body that sags, more one that rings. Which serve an object is found by how
// well the body predicts (docs/decisions/156).
constexpr int kSubsteps = 40, kLeastSubsteps = 12, kMostSubsteps = 300;
constexpr int kMostPerParticle = 4;  // points of a cloud that pull
constexpr double kStiffer = 1.5;     // each further body, in sub-steps

struct FollowedMotion {
  std::vector<Points> position;  // T frames of 3 x particles, m; fewer of one that diverges
  // How far the clouds were from what was predicted of them, mean of the frames, m; infinite of one
  // that diverges.
  double surprise = std::numeric_limits<double>::infinity();
};

// By a body that is as stiff as so many sub-steps a frame bear.
FollowedMotion FollowWith(const Recording& recording, double substeps) {
  SpringMassSystem system = MakeStartSystem(recording, {});
  ScaleToSubsteps(1 / recording.fps, static_cast<int>(substeps), kStepSafety, &system);
  const Points start = recording.start.leftCols(recording.particle_count());
  TrackerBank tracker(
      system, EnvironmentOf(recording),
      {1 / recording.fps, static_cast<int>(substeps), true, LateGraspsOf(recording)},
      MatchWidth(start), recording.point_count(), start, recording.velocity);
  FrameMeasurement measured;
  FollowedMotion motion{.position = {start}};
  double sum = 0;
  for (int frame = 1; frame < recording.frame_count(); ++frame) {
    StopIfRequested();
    measured.cloud = Thinned(recording.surface[static_cast<std::size_t>(frame)],
                             kMostPerParticle * static_cast<int>(start.cols()));
    tracker.Advance(RecordedInput(recording, frame, 0), measured);
    if (!tracker.best().position().allFinite()) return motion;
    motion.position.push_back(tracker.best().position());
    const double surprise = tracker.best().surprise();
    if (std::isfinite(surprise)) sum += surprise;  // else nothing was measured yet
  }
  motion.surprise = sum / (recording.frame_count() - 1);
  return motion;
}

// The bodies on one side of the first one, each by a factor stiffer than the last one, or softer.
struct Way {
  double factor, substeps;  // of the next one
  int worse = 0;            // so many in a row predict no better than the best

  bool IsOpen() const {
    return worse < 2 && substeps >= kLeastSubsteps && substeps <= kMostSubsteps;
  }
};

// Each particle as those near it moved: a cloud that is seen again and again draws them onto its
// points.
Points MoveWithNeighbours(const Points& from, const Points& to) {
  constexpr int kNearest = 12;
  const LocalMotion motion(from, to, kNearest);
  Points moved(3, from.cols());
  for (Eigen::Index i = 0; i < from.cols(); ++i) moved.col(i) = *motion.Move(from.col(i));
  return moved;
}

// The known particles, moved as a rigid body with the controllers, then within a second as a soft
// body with the controllers and the first cloud. `bears`: the known shape bears its weight already,
// so it stays where the cloud shows nothing. Else it hangs anew, as in another shape it would.
Points PulledOver(const Recording& known, const Recording& clouds, bool bears, int threads) {
  constexpr int kFrames = 50;  // of the second
  const Points& there = clouds.controllers[0];
  Points start = known.start.leftCols(known.particle_count()), hands = known.controllers[0];
  if (there.cols() > 0) {
    start = MoveRigidly(known.controllers[0], there, start);
    hands = MoveRigidly(known.controllers[0], there, hands);
  }
  Points at_rest(3, start.cols() + hands.cols());
  at_rest << start, hands;
  Recording way = WithParticles(clouds, start, bears ? at_rest : known.rest);
  way.start = at_rest;
  way.fps = kFrames;
  if (bears) way.gravity.setZero();
  way.points.resize(kFrames + 1, Points::Constant(3, start.cols(), std::nan("")));
  way.surface.assign(kFrames + 1, clouds.surface[0]);
  way.held.resize(0, 0);
  way.controllers.clear();
  for (int t = 0; t <= kFrames; ++t) {
    way.controllers.emplace_back(hands + t / static_cast<double>(kFrames) * (there - hands));
  }
  return MoveWithNeighbours(start, FollowClouds(way, threads).back());
}

}  // namespace

Recording WithParticles(const Recording& clouds, const Points& start, const Points& rest,
                        int interior) {
  Recording recording = clouds;
  const Points points = start.leftCols(start.cols() - interior);
  const Points unseen =
      Points::Constant(3, points.cols(), std::numeric_limits<double>::quiet_NaN());
  recording.points = {points};
  recording.interior = start.rightCols(interior);
  while (recording.points.size() < clouds.surface.size()) recording.points.push_back(unseen);
  recording.start.resize(3, start.cols() + clouds.controller_count());
  recording.start << start, clouds.controllers[0];
  recording.rest = rest;
  recording.velocity = Points::Zero(3, start.cols());
  return recording;
}

Recording AtRestInFrame0(const Recording& clouds, const Points& start) {
  Points rest(3, start.cols() + clouds.controller_count());
  rest << start, clouds.controllers[0];
  return WithParticles(clouds, start, rest);
}

double MatchWidth(const Points& start) {
  const double size = (start.rowwise().maxCoeff() - start.rowwise().minCoeff()).norm();
  return std::max(0.4 * MedianSpacing(start), size / 200);
}

std::vector<Points> FollowClouds(const Recording& recording, int threads) {
  FollowedMotion best;
  std::array<Way, 2> ways{{{kStiffer, kSubsteps}, {1 / kStiffer, kSubsteps / kStiffer}}};
  for (;;) {
    std::vector<Way*> open;
    for (Way& way : ways) {
      if (way.IsOpen()) open.push_back(&way);
    }
    if (open.empty()) break;
    std::vector<FollowedMotion> motions(open.size());
    ParallelFor(static_cast<int>(open.size()), threads, [&](int i) {
      motions[static_cast<std::size_t>(i)] =
          FollowWith(recording, open[static_cast<std::size_t>(i)]->substeps);
    });
    for (std::size_t i = 0; i < open.size(); ++i) {
      const bool better = motions[i].surprise < best.surprise;
      if (better || best.position.empty()) best = std::move(motions[i]);
      open[i]->worse = better ? 0 : open[i]->worse + 1;
      open[i]->substeps *= open[i]->factor;
    }
  }
  if (std::isinf(best.surprise)) {
    throw Error(
        fmt::format("recording {}: the body that the clouds pull along diverges in frame {}",
                    recording.name, best.position.size()));
  }
  return best.position;
}

Points CarryOver(const Recording& known, const Recording& clouds, int threads) {
  if (known.controller_count() != clouds.controller_count()) {
    throw Error(
        fmt::format("recording {}: has {} controllers, but {} has {}; expected recordings of one "
                    "object",
                    clouds.name, clouds.controller_count(), known.name, known.controller_count()));
  }
  const auto off = [&](const Points& start) {
    return UsualDistance(DistancesToNearest(start, clouds.surface[0]));
  };
  Points start = PulledOver(known, clouds, true, threads);
  const double most = kLostWidths * MatchWidth(start);
  if (off(start) > most) {
    const Points other = PulledOver(known, clouds, false, threads);
    if (off(other) < off(start)) start = other;
  }
  if (!(off(start) > most)) return start;
  throw Error(
      fmt::format("recording {}: its first cloud is {:.1f} mm from where the points of {} come to "
                  "be, which are "
                  "{:.1f} mm apart: is it another object, or does it start in another shape?",
                  clouds.name, 1e3 * off(start), known.name, 1e3 * MedianSpacing(start)));
}

}  // namespace physpring

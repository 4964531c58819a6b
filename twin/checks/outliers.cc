// SPDX-License-Identifier: Apache-2.0
#include "twin/checks/outliers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "twin/checks/motion_scale.h"
#include "twin/neighbours.h"

namespace physpring {
namespace {

constexpr int kComparedWith = 6, kFewestCompared = 4;
constexpr double kSpacings = 1.5;  // a jump is larger than so many distances to the nearest point
constexpr int kKeepsVelocity = 3;  // frames
constexpr double kTypical = 15;    // and than so many times the typical difference
constexpr std::size_t kTypicalOf = 1000000;  // differences, or fewer
constexpr double kGapMatters = 2;            // a point that was unseen may move by so many limits
// The distance to either nearest point that is seen changes by less, unless the point jumps.
constexpr int kDistances = 2;
constexpr double kStretches = 0.3;       // of the distance ...
constexpr double kDistanceSlack = 3;     // ... and so many times the typical difference
constexpr std::size_t kNamedTracks = 3;  // tracks that the line names
constexpr double kNothingExplains = std::numeric_limits<double>::infinity();

// Where a point was last as it should be.
struct LastGood {
  int frame = 0;
  Eigen::Vector3d step = Eigen::Vector3d::Zero();  // from the frame before, m
};

class OutlierSearch {
 public:
  explicit OutlierSearch(const Recording& recording) : frames_(recording.points) {
    const Points start = recording.start.leftCols(recording.point_count());
    const NeighbourSearch search(start);
    for (int i = 0; i < recording.point_count(); ++i) {
      near_.push_back(search.Nearest(start.col(i), kComparedWith + 1));
      std::erase_if(near_.back(), [i](const Neighbour& one) { return one.index == i; });
    }
  }

  std::vector<OutlyingTrack> Run() const {
    const double typical = TypicalDifference();
    std::vector<OutlyingTrack> tracks;
    for (int i = 0; i < static_cast<int>(near_.size()); ++i) {
      const double limit = std::max(kSpacings * near_[i][0].distance, kTypical * typical);
      OutlyingTrack track = Follow(i, limit, kDistanceSlack * typical);
      if (!track.frames.empty()) tracks.push_back(std::move(track));
    }
    return tracks;
  }

 private:
  bool Seen(int frame, int i) const { return frames_[frame].col(i).allFinite(); }
  Eigen::Vector3d Step(int i, int from, int to) const {
    return frames_[to].col(i) - frames_[from].col(i);
  }
  // How far the point's step is from the nearest of what may explain it.
  double Difference(int i, const LastGood& last, int frame) const {
    const Eigen::Vector3d step = Step(i, last.frame, frame);
    const int gap = frame - last.frame;
    double least = last.frame > 0 && gap <= kKeepsVelocity ? (step - gap * last.step).norm()
                                                           : kNothingExplains;
    for (const Neighbour& near : near_[i]) {
      if (!Seen(last.frame, near.index) || !Seen(frame, near.index)) continue;
      least = std::min(least, (step - Step(near.index, last.frame, frame)).norm());
    }
    return least;
  }
  LastGood At(int i, int frame, int before) const {
    return {frame, Step(i, before, frame) / (frame - before)};
  }
  double TypicalDifference() const;
  bool KeepsDistances(int i, int from, int to, double slack) const;
  OutlyingTrack Follow(int i, double limit, double slack) const;

  const std::vector<Points>& frames_;
  std::vector<std::vector<Neighbour>> near_;  // of each point, nearest first
};

double OutlierSearch::TypicalDifference() const {
  std::vector<double> differences;
  const auto stride = static_cast<int>(1 + frames_.size() * near_.size() / kTypicalOf);
  for (int frame = 2; frame < static_cast<int>(frames_.size()); frame += stride) {
    for (int i = 0; i < static_cast<int>(near_.size()); ++i) {
      if (!Seen(frame - 2, i) || !Seen(frame - 1, i) || !Seen(frame, i)) continue;
      const double difference = Difference(i, At(i, frame - 1, frame - 2), frame);
      if (std::isfinite(difference)) differences.push_back(difference);
    }
  }
  return Median(std::move(differences));
}

// Whether the point is about as far from its nearest points as it was. A free end that whips leaves
// their motion, but not them.
bool OutlierSearch::KeepsDistances(int i, int from, int to, double slack) const {
  int compared = 0;
  for (const Neighbour& near : near_[i]) {
    if (!Seen(from, near.index) || !Seen(to, near.index)) continue;
    const auto distance = [&](int frame) {
      return (frames_[frame].col(i) - frames_[frame].col(near.index)).norm();
    };
    const double before = distance(from);
    if (std::abs(distance(to) - before) > kStretches * before + slack) return false;
    if (++compared == kDistances) break;
  }
  return compared > 0;
}

OutlyingTrack OutlierSearch::Follow(int i, double limit, double slack) const {
  OutlyingTrack track{i, {}, 0};
  if (!Seen(0, i)) return track;  // placed from neighbours: nothing is known of its path before
  LastGood last;
  bool off = false;
  for (int frame = 1; frame < static_cast<int>(frames_.size()); ++frame) {
    if (!Seen(frame, i)) continue;
    const double difference = Difference(i, last, frame);
    const bool moves_along =
        difference <= (!off && frame - last.frame > 1 ? kGapMatters * limit : limit);
    const bool keeps = KeepsDistances(i, last.frame, frame, slack);
    // who was off must show that it is back
    off = std::isfinite(difference) && (off ? !(moves_along && keeps) : !(moves_along || keeps));
    if (off) {
      if (track.frames.empty()) track.jump = difference;
      track.frames.push_back(frame);
      continue;
    }
    last = At(i, frame, last.frame);
  }
  return track;
}

}  // namespace

std::vector<OutlyingTrack> FindOutliers(const Recording& recording) {
  if (recording.point_count() < kFewestCompared) return {};
  return OutlierSearch(recording).Run();
}

std::string LeaveOutOutliers(const std::string& where, Recording* recording) {
  const std::vector<OutlyingTrack> tracks = FindOutliers(*recording);
  if (tracks.empty()) return "";
  std::size_t left_out = 0;
  std::string named;
  for (const OutlyingTrack& track : tracks) {
    for (int frame : track.frames) {
      recording->points[frame]
          .col(track.point)
          .setConstant(std::numeric_limits<double>::quiet_NaN());
    }
    if (&track - tracks.data() < static_cast<std::ptrdiff_t>(kNamedTracks)) {
      named += fmt::format("{}point {} jumps by {:.3g} m in frame {}", named.empty() ? "" : ", ",
                           track.point, track.jump, track.frames[0]);
    }
    left_out += track.frames.size();
  }
  return fmt::format("{}: {} measurements that leave their neighbours are taken as not seen: {}{}",
                     where, left_out, named, tracks.size() > kNamedTracks ? ", ..." : "");
}

}  // namespace physpring

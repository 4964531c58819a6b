// SPDX-License-Identifier: Apache-2.0
// The way of a scene's mocap bodies in time, as its keyframes tell it:
//
//   <keyframe>
//     <key time="0" mpos="0 0 0.1"/>
//     <key time="1.5" mpos="0.1 0 0.4" mquat="0.7071 0 0.7071 0"/> ...
//
// Between keys each coordinate is a cubic whose slope at a key is the harmonic mean of the slopes
// to both sides, or zero where it turns (Fritsch and Carlson 1980): smooth, at rest between two
// equal keys and at both ends, and never outside the keys around it (never through the floor
// between two keys above it). Quaternions are treated alike and normalised. Before the first and
// after the last key all stand still.
#ifndef PHYSPRING_ROLLOUT_MOCAP_PATH_H_
#define PHYSPRING_ROLLOUT_MOCAP_PATH_H_

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace physpring {

class MocapPath {
 public:
  // Throws Error, beginning with `where`, unless the model has mocap bodies and keys whose times
  // increase.
  MocapPath(const mjModel& model, const std::string& where);

  // Shifts every key after the first, and after time 0, by a random offset of up to `distance` [m]
  // along each axis, the same for all bodies: another motion of the same kind, for each seed.
  void Vary(double distance, std::uint64_t seed);

  // Puts the mocap bodies where they are at `time` [s].
  void Place(double time, mjData* data) const;

  double start_time() const { return time_.front(); }  // s, of the first key
  double end_time() const { return time_.back(); }     // s, of the last key

 private:
  void ComputeSlopes();

  std::vector<double> time_;  // (keys), s, increasing
  Eigen::MatrixXd pose_;      // 7 bodies x keys: positions [m] of all bodies, then quaternions
  Eigen::MatrixXd slope_;     // 7 bodies x keys: their rates [1/s] at the keys
};

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_MOCAP_PATH_H_

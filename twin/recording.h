// SPDX-License-Identifier: Apache-2.0
// A recording: measured 3-D points of one deformable object and of the grasps that move it, at a
// fixed frame rate; what was measured at times of its own is brought to one (recording_clocks.h). T
// frames, N points, M interior particles, C controllers. SI units, z up.
#ifndef PHYSPRING_TWIN_RECORDING_H_
#define PHYSPRING_TWIN_RECORDING_H_

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "twin/npz.h"
#include "twin/points.h"
#include "twin/rod.h"

namespace physpring {

struct Recording {
  std::string name;  // file name without folder and extension
  std::string hash;  // the hash of the file's content, 16 hex digits; empty if not read from a file

  std::vector<Points> points;       // T frames of 3 x N, m; a column of NaN = not seen
  std::vector<Points> controllers;  // T frames of 3 x C, m; C may be 0
  double fps = 0;                   // frames per second, > 0
  // Whether points and controllers came with times of clocks of their own, which may differ.
  bool two_clocks = false;
  // T frames of 3 x C: the forces with which the grasps pull the object, N; or of 1 x C: their
  // sizes. NaN: not measured. May be empty.
  std::vector<Eigen::MatrixXd> force;

  // T frames of 1 x N: how much each measurement of a point counts beside the others, as its
  // inverse variance; 1 on the average of those that are seen. Empty: all alike.
  std::vector<Eigen::MatrixXd> weight;

  double mass = 0.1;                      // the object's, kg
  Eigen::Vector3d gravity{0, 0, -9.81};   // m/s^2
  std::optional<Eigen::Vector4d> ground;  // plane (a, b, c, d): a x + b y + c z = d, |(a,b,c)| = 1

  // T x C: whether a controller holds the object in a frame; empty: always. Each holds once, from a
  // frame to another one (grasps.h).
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> held;
  // For each frame in which a controller takes hold after the start: where all particles are then,
  // 3 x (N+M), m.
  std::map<int, Points> shape_when_held;

  Points interior;              // 3 x M, m: unobserved particles in frame 0; M may be 0
  Points rest;                  // 3 x (N+M+C), m: stress-free positions; default: frame 0
  bool rest_given = false;      // false: `rest` is frame 0
  Points velocity;              // 3 x (N+M), m/s: at frame 0; default: checks/start_velocity.h
  Rod rod;                      // of N+M+C columns; empty if not a rod
  std::vector<Points> surface;  // T frames of 3 x S, m, unlabelled surface points; may be empty
  std::vector<Points> track;    // T frames of 3 x K, m, key points; empty: `points` are tracked

  int train_frames = 0;  // frames before it are for fitting, the rest is the future to predict

  // The number of the object of each particle and controller (N+M+C), where the reader found more
  // than one (checks/objects.h); else empty.
  Eigen::VectorXi object;

  // What the reader had to assume or finds odd, one line each (mass not declared, points placed,
  // positions that can hardly be in metres ...).
  std::vector<std::string> warnings;
  // What it worked out and is no cause for concern (velocities of a start in motion).
  std::vector<std::string> notes;

  double WeightOf(int frame, Eigen::Index point) const {
    return weight.empty() ? 1 : weight[static_cast<std::size_t>(frame)](0, point);
  }
  int frame_count() const { return static_cast<int>(points.size()); }
  int point_count() const { return points.empty() ? 0 : static_cast<int>(points[0].cols()); }
  int interior_count() const { return static_cast<int>(interior.cols()); }
  int controller_count() const {
    return controllers.empty() ? 0 : static_cast<int>(controllers[0].cols());
  }
  int particle_count() const { return point_count() + interior_count(); }

  // Positions of points, interior particles and controllers in frame 0: 3 x (N+M+C), finite.
  // Points not seen in frame 0 were placed by the reader from their neighbours (see warnings).
  Points start;
};

// Reads NAME.npz. Throws Error naming file, array and expectation when anything is malformed:
// unreadable or truncated file, missing array, wrong shape or type, NaN where none may be.
// Arrays that the format does not define are an error, too, and clouds (`surface`) without points.
Recording ReadRecording(const std::string& path);

// The same, but there may be clouds alone: `points` are then frames of 3 x 0.
Recording ReadRecordingOrClouds(const std::string& path);

// Throws Error, beginning with `path`, if the recording has clouds alone.
void ExpectPoints(const Recording& recording, const std::string& path);

// ReadRecordingOrClouds for arrays already in memory, without the hash; `path` gives the name and
// begins messages. Move large ones here: they are let go before the checks.
Recording ParseRecording(Npz arrays, const std::string& path);

// Writes `recording` to `path` atomically (temporary file, fsync, rename), deflated; positions and
// velocities in float32, so that ReadRecording gives the same recording back up to float32. Throws
// Error for a recording that ReadRecording would refuse, and then writes nothing.
void WriteRecording(const Recording& recording, const std::string& path);

// The arrays that WriteRecording writes. Throws Error where there are none for it (recorded_rod.h).
Npz StoreRecording(const Recording& recording);

// `recording` as ReadRecording would give it back, had it been written: in float32, checked,
// without outliers, with the start velocities that are worked out. Throws Error as that would.
Recording AsReadBack(const Recording& recording);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_RECORDING_H_

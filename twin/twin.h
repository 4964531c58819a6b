// SPDX-License-Identifier: Apache-2.0
// A twin: the learned spring-mass systems of one object, from dense (level 0) to coarse, with all
// that is needed to use, judge, export and go on training them.
#ifndef PHYSPRING_TWIN_TWIN_H_
#define PHYSPRING_TWIN_TWIN_H_

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "twin/controller_mask.h"
#include "twin/fit_errors.h"
#include "twin/linear_predictor.h"
#include "twin/material.h"
#include "twin/npz.h"
#include "twin/posterior.h"
#include "twin/spring_mass_system.h"

namespace physpring {

// A recording that a twin was trained on.
struct TrainedOn {
  std::string name;
  std::string hash;      // Recording::hash
  int train_frames = 0;  // frames before it were used for fitting
};

struct TwinLevel {
  SpringMassSystem system;
  std::vector<int> assignment;  // node of the level below -> node of this level; empty at level 0
  int substeps_per_second = 0;  // sub-steps it was trained with, per second of time
};

// The ground of the recordings that a twin was trained on.
struct TrainedGround {
  bool known = false;  // files of older programs do not say
  std::optional<Eigen::Vector4d>
      plane;  // (a, b, c, d): a x + b y + c z = d, |(a,b,c)| = 1, or none
};

struct Twin {
  std::string name;
  std::vector<TwinLevel> levels;

  // What the columns of level 0 are: points, interior particles (as in the recording), controllers.
  int points = 0;
  int interior = 0;
  Rod rod;                          // of level 0's nodes and controllers; empty if not a rod
  bool controller_velocity = true;  // dashpots feel the controllers' velocity (false: PhysTwin)
  // The controllers that take hold within the recording, so hold nothing at its start.
  ControllerMask late;
  double fps = 0;
  Eigen::Vector3d gravity{0, 0, -9.81};
  TrainedGround ground;

  std::optional<Material> material;  // of level 0, if its fit estimates it
  Posterior posterior;               // of level 0; empty if its fit does not estimate it
  LinearPredictor linear;            // of the recordings that it was trained on; may be empty

  // How much later the controllers of its recordings moved than their clock says, s; none: not
  // sought, since the recordings have one clock.
  std::optional<double> clock_offset;
  // What its masses and stiffnesses were multiplied by, so that the forces at its controllers are
  // as measured; none: no force was measured, and only their ratios are known.
  std::optional<double> force_scale;

  std::vector<TrainedOn> trained_on;
  std::optional<FitErrors> fit_errors;  // of level 0 as its training ended; files of older programs
                                        // do not say
  std::string options_json = "{}";      // the options it was trained with, a compact JSON object
  std::uint64_t seed = 0;

  // What it says of its training on the recording of that hash; null if it was not trained on it.
  const TrainedOn* TrainingOn(const std::string& hash) const {
    const auto found = std::find_if(
        trained_on.begin(), trained_on.end(),
        [&](const TrainedOn& trained) { return !hash.empty() && trained.hash == hash; });
    return found == trained_on.end() ? nullptr : &*found;
  }

  // Optimiser state, counters and the like, under the names their owner chose: "train/NAME".
  std::map<std::string, NpzArray> training_state;
};

// Reads NAME.twin.npz; throws Error naming file, array and expectation. What is read is what was
// written, bit for bit.
Twin ReadTwin(const std::string& path);

// The same for arrays already in memory; `path` begins the messages.
Twin ParseTwin(const Npz& arrays, const std::string& path);

// The arrays of its file. Throws Error, which begins with `path`, for a twin that ReadTwin would
// refuse.
Npz CheckedArraysOf(const Twin& twin, const std::string& path);

// Writes atomically: the file at `path` is the old one or the new one, whatever happens. Throws
// Error for a twin that ReadTwin would refuse (a level without springs or without
// substeps_per_second, an assignment that is not onto, ...), and then writes nothing.
void WriteTwin(const Twin& twin, const std::string& path);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_TWIN_H_

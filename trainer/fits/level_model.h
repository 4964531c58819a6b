// SPDX-License-Identifier: Apache-2.0
// A coarse level whose parameters are fitted (level_fit.h): what moves it, from a few factors to
// single springs, how it follows the recordings, and by what it is judged.
#ifndef PHYSPRING_TRAINER_FITS_LEVEL_MODEL_H_
#define PHYSPRING_TRAINER_FITS_LEVEL_MODEL_H_

#include "trainer/bodies/parameters.h"
#include "trainer/data/fit_data.h"
#include "trainer/data/held_back.h"
#include "trainer/data/train_options.h"
#include "trainer/motion/lifted_motion.h"
#include "trainer/network/graph_network.h"

namespace physpring {

// Common factors, the network's weights, and what is added to the logits of the ground's
// coefficients of contact.
struct LevelValues {
  Eigen::VectorXd common, weights, contact;
};

class LevelModel {
 public:
  // The last level of `twin`, softened where it would need more sub-steps than level 0. `data`,
  // `options` and `network` must outlive this.
  LevelModel(const FitData& data, const TrainOptions& options, const Twin& twin,
             const GraphNetwork& network);

  const FitData& data() const { return data_; }
  const TrainOptions& options() const { return options_; }
  const Recording& first() const { return data_.recordings[0]; }
  const Twin& twin() const { return twin_; }
  int level() const { return level_; }
  const GraphNetwork& network() const { return network_; }

  Parameters CommonParameters() const;
  // The system that the network corrects: with the common factors, and with the contact's
  // coefficients as they are updated. The network adds to the same logits as these updates.
  SpringMassSystem NetworkBase(const LevelValues& values) const;
  // The system with the network's corrections.
  SpringMassSystem Corrected(const LevelValues& values) const;

  // The motion of the level. Motion goes through all frames for fitting of at most `most`
  // recordings, under an observer of this gain. MotionNotHeldBack leaves out the frames that are
  // held back, and has no observer.
  LiftedMotion Motion(int threads, double gain, int most) const;
  LiftedMotion MotionNotHeldBack() const;
  // The motion for differences that may leave its neighbourhood: its adjoint is never cut.
  LiftedMotion RoughMotion(int most) const;

  // The mean track error of the held-back frames, m, under the observer's last gain above 0: free
  // motions that slip at one moment or another would decide by chance. Infinite where it diverges.
  double HeldBackError(const SpringMassSystem& system) const;

  // `system` as a level of the twin, with the sub-steps that it needs.
  TwinLevel LevelOf(const SpringMassSystem& system) const;

 private:
  LiftedMotion::Options MotionOptions(int threads, double gain) const;

  const FitData& data_;
  const TrainOptions& options_;
  Twin twin_;
  int level_;
  int most_substeps_;  // the most sub-steps of a frame
  HeldBack held_back_;
  const GraphNetwork& network_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_LEVEL_MODEL_H_

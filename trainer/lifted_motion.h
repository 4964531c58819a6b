// SPDX-License-Identifier: Apache-2.0
// Rollouts of one level of a twin on several recordings, and the particles of level 0 that the
// level's nodes carry along (lift.h): what a level is fitted by.
#ifndef PHYSPRING_TRAINER_LIFTED_MOTION_H_
#define PHYSPRING_TRAINER_LIFTED_MOTION_H_

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "trainer/rollout.h"
#include "twin/lift.h"
#include "twin/stability.h"
#include "twin/twin.h"

namespace physpring {

class LiftedMotion {
 public:
  struct Options {
    RolloutOptions rollout;       // substeps: 0 = from the stability bound
    double safety = kStepSafety;  // sub-step as a part of the largest stable one
    int most_substeps = 2000;     // a frame; a stiffer system cannot be rolled out
    int threads = 1;
  };

  // `level` needs its topology, masses and reference positions; parameters come with each call. The
  // recordings must outlive this.
  LiftedMotion(const Twin& twin, int level, const std::vector<Episode>& episodes,
               const Options& options);

  // Of each episode, of each frame.
  using Frames = std::vector<std::vector<Points>>;

  struct Motion {
    std::vector<std::unique_ptr<Rollout>> rollouts;
    Frames particles;  // 3 x particles, m
  };

  int episode_count() const { return static_cast<int>(episodes_.size()); }
  const Recording& recording(int episode) const { return *episodes_[episode].recording; }
  int frames(int episode) const { return episodes_[episode].frames; }

  // Sub-steps a frame for the system; 0 if more than most_substeps would be needed.
  int Substeps(const SpringMassSystem& system) const;

  // Nothing where a rollout diverges or `substeps` is 0.
  std::optional<Motion> Run(const SpringMassSystem& system, int substeps) const;

  // Derivatives with respect to the system that `motion` was made with, from those with respect to
  // motion.particles. `cuts` (may be null): how often the adjoint was cut (rollout.h).
  SystemGradient Adjoint(const SpringMassSystem& system, const Motion& motion,
                         const Frames& particles_bar, int* cuts) const;

  // Zeros in the shape of motion.particles.
  static Frames ZerosLike(const Frames& particles);

 private:
  // Calls work(episode, frame) for all frames, in parallel.
  void ForEachFrame(const std::function<void(int, int)>& work) const;

  std::vector<Episode> episodes_;   // as measured
  std::vector<Recording> carried_;  // the start and the controllers, for the level's nodes
  std::vector<Lift> lifts_;
  Options options_;
};

// Track error of frames first .. last - 1 of an episode: the mean over frames of the mean distance
// of particles from seen points, m. Nothing if nothing is seen.
std::optional<double> MeanTrackError(const std::vector<Points>& particles,
                                     const Recording& recording, int first, int last);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_LIFTED_MOTION_H_

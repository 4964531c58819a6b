// SPDX-License-Identifier: Apache-2.0
// Rollouts of one level of a twin on several recordings, and the particles of level 0 that the
// level's nodes carry along (lift.h): what a level is fitted by. The nodes of level 0 are the
// particles themselves.
#ifndef PHYSPRING_TRAINER_MOTION_LIFTED_MOTION_H_
#define PHYSPRING_TRAINER_MOTION_LIFTED_MOTION_H_

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "trainer/motion/rollout.h"
#include "twin/lift.h"
#include "twin/stability.h"
#include "twin/twin.h"

namespace physpring {

class LiftedMotion {
 public:
  struct Options {
    RolloutOptions rollout;       // substeps: 0 = from the stability bound
    double safety = kStepSafety;  // sub-step as a part of the largest stable one
    // Sub-steps a frame, in those of one dashpot stage; a dearer system cannot be rolled out.
    int most_substeps = 2000;
    double least_rate = 0;  // sub-steps a second, at least ...
    // ... and at most, in those of one dashpot stage; a dearer system cannot be rolled out.
    double most_rate = std::numeric_limits<double>::infinity();
    std::size_t lasting_effects = 0;  // only the first so many act in episodes before a change
    int threads = 1;
  };

  // The motion of level 0, whose nodes are the particles. The recordings must outlive this.
  LiftedMotion(std::vector<Episode> episodes, const Options& options);

  // `level` needs its topology, masses and reference positions; parameters come with each call. The
  // recordings must outlive this.
  LiftedMotion(const Twin& twin, int level, std::vector<Episode> episodes, const Options& options);

  // The motion of one episode.
  struct Motion {
    std::unique_ptr<Rollout> rollout;  // null where there is nothing to predict
    std::vector<Points> lifted;        // the particles in each frame; empty at level 0

    const std::vector<Points>& particles() const {  // 3 x particles, m, for each frame
      return lifted.empty() && rollout ? rollout->positions() : lifted;
    }
  };

  int episode_count() const { return static_cast<int>(episodes_.size()); }
  const Episode& episode(int e) const { return episodes_[static_cast<std::size_t>(e)]; }
  int threads() const { return options_.threads; }

  struct Substeps {
    std::vector<int> counts;  // sub-steps a frame, one number for each episode
    int dashpot_stages = 1;

    bool empty() const { return counts.empty(); }
    auto operator<=>(const Substeps&) const = default;
  };

  // The cheapest that are stable with at most the system's stages; empty if that is too many.
  Substeps SubstepsOf(const SpringMassSystem& system) const;
  // Whether the system is stable with these sub-steps, and needs no more than the options allow.
  bool AreEnough(const Substeps& substeps, const SpringMassSystem& system) const;

  // The motion of episode `e`; nothing where the rollout diverges.
  std::optional<Motion> RunOne(int e, const SpringMassSystem& system,
                               const Substeps& substeps) const;
  // The particles of episode `e` in each frame, for each of the systems; nothing where the rollout
  // diverges. The same as from one after the other (lane_rollout.h).
  std::vector<std::optional<std::vector<Points>>> RunSideBySide(
      int e, std::vector<SpringMassSystem> systems, const Substeps& substeps) const;
  // The motions of all episodes; nothing where a rollout diverges or there are no `substeps`.
  std::optional<std::vector<Motion>> Run(const SpringMassSystem& system,
                                         const Substeps& substeps) const;

  // Derivatives with respect to the system that `motions` were made with, from those with respect
  // to the particles of each episode's frames. `cuts` (may be null): how often the adjoint was cut
  // (rollout.h).
  using ParticlesBar = std::function<std::vector<Points>(int episode)>;
  SystemGradient Adjoint(const SpringMassSystem& system, const std::vector<Motion>& motions,
                         const ParticlesBar& particles_bar, int* cuts) const;

  static std::vector<Points> ZerosLike(std::vector<Points> frames);

 private:
  RolloutOptions RolloutOf(int e, const Substeps& substeps) const;
  // The system without those effects that do not act in episodes from before a change.
  SpringMassSystem BeforeChange(SpringMassSystem system) const;
  // RunSideBySide with the systems as they are.
  std::vector<std::optional<std::vector<Points>>> RunAll(
      int e, const std::vector<SpringMassSystem>& systems, const Substeps& substeps) const;
  Episode EpisodeOfNodes(int e) const;
  std::vector<Points> Lifted(int e, const std::vector<Points>& positions) const;

  // Where there is one episode only, its parts run in parallel.
  int ThreadsOfOne() const { return episodes_.size() == 1 ? options_.threads : 1; }

  std::vector<Episode> episodes_;  // as measured
  Options options_;
  // what only a coarser level has:
  std::vector<Recording> carried_;  // the start and the controllers, for the level's nodes
  std::vector<Lift> lifts_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_MOTION_LIFTED_MOTION_H_

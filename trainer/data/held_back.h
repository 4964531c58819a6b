// SPDX-License-Identifier: Apache-2.0
// What a choice (neighbour count, start values) is fitted on and what it is judged by: part of the
// fit frames is held back. Frames from train_frames on are never touched.
#ifndef PHYSPRING_TRAINER_DATA_HELD_BACK_H_
#define PHYSPRING_TRAINER_DATA_HELD_BACK_H_

#include <vector>

#include "trainer/data/episode.h"
#include "trainer/data/fit_data.h"

namespace physpring {

struct HeldBack {
  std::vector<SplitRecording> fit;     // the frames to fit; the others have no use
  std::vector<SplitRecording> judged;  // the frames that are held back, and those to fit between

  // Episodes of all fit frames of the recordings in `fit`, and in `judged`, where those that are
  // held back count. *this must outlive them.
  std::vector<Episode> FitEpisodes() const;
  std::vector<Episode> JudgedEpisodes() const;
};

// With four or more continuous runs, whole runs are held back (a quarter of them, spread evenly);
// otherwise the fourth and the last eighth of each recording's fit frames. HoldBack takes at most
// `most` recordings on each side, spread evenly. `data` must outlive the result.
HeldBack HoldBack(const FitData& data, int most);

// Motions that no fit has seen, by which a choice between bodies of few and of many numbers is
// judged: blocks between fitted frames would not tell, since many numbers bend to both.
struct HeldBackMotion {
  FitData fit;                         // what to fit
  std::vector<SplitRecording> judged;  // in use: what is held back

  // Episodes of all fit frames. *this must outlive them.
  std::vector<Episode> JudgedEpisodes() const;
};

// With four or more continuous runs, a quarter of them; otherwise the later third of each
// recording's fit frames. At most `most` recordings are judged, spread evenly. `data` must outlive
// the result.
HeldBackMotion HoldBackMotion(const FitData& data, int most);

// Whether each recording belongs to a run that is held back whole. A quarter of the runs are held
// back, spread evenly; none if there are fewer than four.
std::vector<bool> HeldBackRuns(const FitData& data);

// At most `most` of `all`, spread evenly.
template <class T>
std::vector<T> SpreadEvenly(const std::vector<T>& all, int most) {
  const int count = static_cast<int>(all.size());
  if (count <= most) return all;
  std::vector<T> some;
  for (int i = 0; i < most; ++i) some.push_back(all[(2 * i + 1) * count / (2 * most)]);
  return some;
}

// All fit frames of at most `most` recordings, spread evenly.
std::vector<Episode> FitEpisodes(const FitData& data, int most);

// The particles of `most` recordings, spread evenly, in all fit frames: how much there is to
// follow.
double ParticleFrames(const FitData& data, int most);

// The same recordings with no more fit frames than tell which body to choose: of many particles
// the first ones alone. `most` is how many recordings will be followed.
FitData ShortMotions(const FitData& data, int most);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_DATA_HELD_BACK_H_

// SPDX-License-Identifier: Apache-2.0
// An episode in a folder: LEVEL/episode_00007.npz (states and actions), .seconds.json (timing) and,
// last, .json (the verdict), whose presence says that the episode is finished. All but the timing
// is the same, byte for byte, whenever the same episode is run again.
#ifndef PHYSPRING_ROLLOUT_EPISODE_FILES_H_
#define PHYSPRING_ROLLOUT_EPISODE_FILES_H_

#include <optional>
#include <string>

#include "rollout/episode.h"

namespace physpring {

// What is kept in memory of each episode of a sweep.
struct EpisodeSummary {
  int episode = 0;
  int level = 0;
  int frames = 0;  // simulated
  bool success = false;
  int met_frames = 0;
  double value = 0;  // the success rule's in the last frame; 0 without frames
  std::string problem;
  std::optional<EpisodeSeconds> seconds;  // nothing where their file is not sound
};

EpisodeSummary Summarise(const EpisodeResult& result);

// FOLDER/level3/episode_00007, without an extension.
std::string EpisodePath(const std::string& folder, int level, int episode);

// Writes the three files, each atomically. `states`: with the states of all frames, else only the
// actions. Throws Error when they cannot be written.
void WriteEpisode(const std::string& folder, const EpisodeResult& result, bool states);

// The summary of a finished episode, or nothing. Throws Error, beginning with the file, when one of
// its files is damaged, or the one with states and actions is missing.
std::optional<EpisodeSummary> ReadEpisode(const std::string& folder, int level, int episode);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_EPISODE_FILES_H_

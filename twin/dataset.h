// SPDX-License-Identifier: Apache-2.0
// Which recordings the arguments of `train` and `eval` stand for: a file is itself, a folder with a
// dataset.json, or that file, is its recordings of one role. Of that file only these keys are read:
//   {"recordings": [{"file": "a.npz", "role": "fit" or "heldout", "continuous_recording": 0}, ...],
//    "published_l1_m": {...}}
#ifndef PHYSPRING_TWIN_DATASET_H_
#define PHYSPRING_TWIN_DATASET_H_

#include <string>
#include <vector>

namespace physpring {

enum class Role { kFit, kHeldout };

struct RecordingEntry {
  std::string path;
  bool heldout = false;  // its role in the data set; a file given by itself is not held out
  int continuous_recording = -1;  // files of equal number follow each other in time; -1: not said
  bool published_l1 = false;      // whether its data set has published errors in the L1 metric
};

// The recordings of `arguments` in their order, those of a folder in the order of its file. A file
// given by itself has the fields of the dataset.json beside it, if that lists it. Throws
// Error, beginning with the path and naming the key, when a path does not exist, a folder has no
// dataset.json or none of the role, or a file is listed twice.
std::vector<RecordingEntry> ListRecordings(const std::vector<std::string>& arguments, Role role);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_DATASET_H_

// SPDX-License-Identifier: Apache-2.0
// A twin file is the checkpoint of the training that writes it. It holds the twin so far, the state
// that the training goes on from, and what the twin is trained on and how.
#ifndef PHYSPRING_JOBS_CHECKPOINT_H_
#define PHYSPRING_JOBS_CHECKPOINT_H_

#include <optional>
#include <string>

#include "trainer/data/fit_data.h"
#include "trainer/data/train_options.h"
#include "trainer/journal/journal.h"
#include "twin/twin.h"

namespace physpring {

// Whether the training that wrote a twin came to its end. True for a twin from elsewhere.
bool IsFinished(const Twin& twin);

class Checkpoint {
 public:
  // The checkpoint of the training on `data` with `options`, which writes to `path`; if that is
  // empty, nothing is written or read. `from` is the file that level 0 comes from; if it is empty,
  // level 0 is fitted.
  Checkpoint(const std::string& path, const FitData& data, const TrainOptions& options,
             const std::string& from);

  // Throws Error if the file at `path` is no twin, or if it is a twin and `force` is not set.
  void ExpectReplaceable(bool force) const;

  // Gives `journal` what the file holds and returns its twin; returns nothing if there is no file.
  // Throws Error if the file is no twin, or if its training had other recordings, other options
  // (the message names the first that differs) or another version of the program.
  std::optional<Twin> Resume(Journal* journal) const;

  // The key of what all pieces of this training depend on.
  PieceKey Key() const;

  // Both write the file, whole or not at all, and return what is in it. Write stores the twin so
  // far and what its training goes on from, WriteFinished the finished twin.
  Twin Write(const Twin& so_far, const Journal& journal) const;
  Twin WriteFinished(const Twin& twin) const;

  // What WriteFinished writes.
  Twin Finished(const Twin& twin) const { return Labelled(twin, true); }

 private:
  bool IsFile() const;
  void ExpectSameTraining(const Twin& twin) const;
  Twin Labelled(const Twin& twin, bool finished) const;

  std::string path_;
  Twin labels_;  // only name, trained_on, options_json and seed are set
};

}  // namespace physpring

#endif  // PHYSPRING_JOBS_CHECKPOINT_H_

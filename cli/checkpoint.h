// SPDX-License-Identifier: Apache-2.0
// A twin file as the checkpoint of the training that writes it: the twin so far, with the state
// that the training goes on from, and with what it was trained on and how.
#ifndef PHYSPRING_CLI_CHECKPOINT_H_
#define PHYSPRING_CLI_CHECKPOINT_H_

#include <optional>
#include <string>

#include "trainer/data/fit_data.h"
#include "trainer/data/train_options.h"
#include "trainer/journal/journal.h"
#include "twin/twin.h"

namespace physpring {

// Whether the training that wrote a twin came to its end; true of a twin from elsewhere.
bool IsFinished(const Twin& twin);

// Says so on stderr if it did not.
void WarnIfUnfinished(const Twin& twin, const std::string& path);

class Checkpoint {
 public:
  // Of the training on `data` with `options` that writes to `path`. `from`: the file that level 0
  // comes from; empty: it is fitted.
  Checkpoint(const std::string& path, const FitData& data, const TrainOptions& options,
             const std::string& from);

  // Throws Error if there is a file that is no twin, or a twin that would be overwritten without
  // `force`.
  void ExpectReplaceable(bool force) const;

  // Gives `journal` what is in the file, and returns its twin; nothing if there is no file. Throws
  // Error if the file is no twin, or one of other recordings, other options (naming the first that
  // differs) or another version of the program.
  std::optional<Twin> Resume(Journal* journal) const;

  // What the pieces of this training depend on, all together.
  PieceKey Key() const;

  // Write the file, atomically: the twin so far and what its training goes on from, or the finished
  // twin. Both return what is in it.
  Twin Write(const Twin& so_far, const Journal& journal) const;
  Twin WriteFinished(const Twin& twin) const;

 private:
  void ExpectSameTraining(const Twin& twin) const;
  Twin Labelled(const Twin& twin, bool finished) const;

  std::string path_;
  Twin labels_;  // only name, trained_on, options_json and seed are set
};

}  // namespace physpring

#endif  // PHYSPRING_CLI_CHECKPOINT_H_

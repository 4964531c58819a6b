// SPDX-License-Identifier: Apache-2.0
// checkpoint.npz in the folder of a diagnosis. It holds what the diagnosis has worked out so far
// (journal.h) and what is diagnosed, so that a diagnosis that was stopped can go on.
#ifndef PHYSPRING_JOBS_DIAGNOSIS_CHECKPOINT_H_
#define PHYSPRING_JOBS_DIAGNOSIS_CHECKPOINT_H_

#include <string>
#include <vector>

#include "diagnosis/diagnosis.h"
#include "trainer/journal/journal.h"

namespace physpring {

class DiagnosisCheckpoint {
 public:
  // The checkpoint at `path` of the diagnosis of the file `twin` on these recordings.
  DiagnosisCheckpoint(const std::string& path, const std::string& twin,
                      const DiagnosisRecordings& recordings, const DiagnosisOptions& options);

  const std::string& path() const { return path_; }

  // Throws Error if the folder holds a diagnosis, finished (it has the file `report`) or not,
  // unless it is `allowed` to replace it.
  void ExpectReplaceable(const std::string& report, bool allowed) const;

  // Gives `journal` what the file holds; does nothing if there is no file. Throws Error if the file
  // is no checkpoint, or if it is one of another diagnosis (the message names the first thing that
  // differs).
  void Resume(Journal* journal) const;

  // Writes the file, whole or not at all.
  void Write(const Journal& journal) const;

  // Marks the file that was written as finished.
  void Finish() const;

 private:
  std::string path_;
  std::string of_json_;  // what is diagnosed, and by which program
};

}  // namespace physpring

#endif  // PHYSPRING_JOBS_DIAGNOSIS_CHECKPOINT_H_

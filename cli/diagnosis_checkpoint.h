// SPDX-License-Identifier: Apache-2.0
// checkpoint.npz in the folder of a diagnosis: what it has worked out so far (journal.h), and of
// what, so that a diagnosis that was stopped goes on.
#ifndef PHYSPRING_CLI_DIAGNOSIS_CHECKPOINT_H_
#define PHYSPRING_CLI_DIAGNOSIS_CHECKPOINT_H_

#include <string>
#include <vector>

#include "trainer/diagnosis/diagnosis.h"
#include "trainer/journal/journal.h"

namespace physpring {

class DiagnosisCheckpoint {
 public:
  // At `path`; of the diagnosis of the twin file on recordings.
  DiagnosisCheckpoint(const std::string& path, const std::string& twin,
                      const std::vector<Recording>& recordings,
                      const std::vector<Recording>& held_out, const DiagnosisOptions& options);

  const std::string& path() const { return path_; }

  // Throws Error if there is a diagnosis in the folder, finished (it has `report`) or not, that
  // would be overwritten without `allowed`.
  void ExpectReplaceable(const std::string& report, bool allowed) const;

  // Gives `journal` what is in the file; nothing if there is none. Throws Error if the file is no
  // checkpoint, or one of something else (naming the first that differs).
  void Resume(Journal* journal) const;

  // Writes the file, atomically.
  void Write(const Journal& journal) const;

  // Marks the file that was written as finished.
  void Finish() const;

 private:
  std::string path_;
  std::string of_json_;  // what is diagnosed
};

}  // namespace physpring

#endif  // PHYSPRING_CLI_DIAGNOSIS_CHECKPOINT_H_

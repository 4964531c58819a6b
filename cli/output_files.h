// SPDX-License-Identifier: Apache-2.0
// The files that a command writes, checked before it works for them.
#ifndef PHYSPRING_CLI_OUTPUT_FILES_H_
#define PHYSPRING_CLI_OUTPUT_FILES_H_

#include <string>
#include <vector>

namespace physpring {

// Throws Error if one of `outputs` cannot be written, is one of `inputs`, or is another output.
// Empty names are options that were not given.
void ExpectOutputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs);

// Whether there is a file or folder, as far as can be told.
bool Exists(const std::string& path);

// Throws Error if there is a file at `path`, unless `force`.
void ExpectNew(const std::string& path, bool force);

// A folder for outputs. One that was not there goes again if nothing was written into it.
class OutputFolder {
 public:
  explicit OutputFolder(const std::string& path);
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder();

 private:
  std::string path_;
  bool was_there_;
};

}  // namespace physpring

#endif  // PHYSPRING_CLI_OUTPUT_FILES_H_

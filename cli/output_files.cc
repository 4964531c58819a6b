// SPDX-License-Identifier: Apache-2.0
#include "cli/output_files.h"

#include <fmt/format.h>

#include <filesystem>

#include "twin/atomic_file.h"
#include "twin/error.h"

namespace physpring {
namespace {

namespace fs = std::filesystem;

// Links to one file, and other spellings of its path, are the same.
bool AreSame(const std::string& p, const std::string& q) {
  std::error_code missing;
  if (fs::equivalent(p, q, missing) && fs::is_regular_file(p, missing)) return true;
  return !fs::exists(p, missing) &&
         fs::weakly_canonical(p, missing) == fs::weakly_canonical(q, missing);
}

}  // namespace

bool Exists(const std::string& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

void ExpectOutputs(const std::vector<std::string>& outputs,
                   const std::vector<std::string>& inputs) {
  for (auto output = outputs.begin(); output != outputs.end(); ++output) {
    if (output->empty()) continue;
    if (*output == "-") {
      throw Error("-: is no file name here; standard output is for the report to read");
    }
    for (const std::string& input : inputs) {
      if (AreSame(*output, input)) {
        throw Error(fmt::format("{}: is read by this command and cannot be written", *output));
      }
    }
    for (auto other = outputs.begin(); other != output; ++other) {
      if (!other->empty() && AreSame(*output, *other)) {
        throw Error(fmt::format("{}: two outputs have this name", *output));
      }
    }
    ExpectFileWritable(*output);
  }
}

void ExpectNew(const std::string& path, bool force) {
  std::error_code missing;
  if (force || !fs::is_regular_file(path, missing)) return;
  throw Error(fmt::format("{}: exists; --force overwrites", path));
}

OutputFolder::OutputFolder(const std::string& path) : path_(path), was_there_(Exists(path)) {
  MakeFolder(path);
}

OutputFolder::~OutputFolder() {
  std::error_code not_empty;
  if (!was_there_) fs::remove(path_, not_empty);
}

}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
#include "twin/output_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "twin/error.h"

namespace physpring {
namespace {

namespace fs = std::filesystem;

// Equal for all names of one output; empty for a device.
std::string LockOf(const std::string& output) {
  std::error_code missing;
  const fs::path found = fs::canonical(output, missing);
  if (missing) return output + ".lock";  // a new file
  if (fs::is_directory(found, missing)) return (found / ".lock").string();
  return fs::is_regular_file(found, missing) ? found.string() + ".lock" : "";
}

}  // namespace

OutputLock::OutputLock(const std::string& output) : path_(LockOf(output)) {
  if (path_.empty()) return;
  do {
    file_ = Descriptor(path_, O_RDWR | O_CREAT | O_NOFOLLOW);
    if (!file_.is_open()) {
      throw Error(fmt::format("{}: cannot be locked: {}", output, std::strerror(errno)));
    }
    if (file_.TryLock() == Descriptor::Lock::kHeldByAnother) {
      throw Error(fmt::format(
          "{}: another physpring is writing it; wait for its end, or choose another output",
          output));
    }
  } while (!file_.HasName());  // the run that had it has just removed it
}

OutputLock::~OutputLock() {
  if (file_.is_open()) unlink(path_.c_str());
}

}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
#include "twin/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "twin/descriptor.h"
#include "twin/draft_file.h"
#include "twin/error.h"

namespace physpring {
namespace {

[[noreturn]] void FailToWrite(const std::string& path, int error) {
  throw Error(fmt::format("{}: cannot be written: {}", path, std::strerror(error)));
}

[[noreturn]] void FailAsNoFile(const std::string& path) {
  throw Error(fmt::format(
      "{}: cannot be read: is a pipe or a device; copy what it holds to a file first", path));
}

// Where the links lead, so that a link stays a link and /dev/stdout stays a device.
std::string FollowLinks(const std::string& path) {
  std::error_code missing;
  const std::filesystem::path resolved = std::filesystem::canonical(path, missing);
  return missing ? path : resolved.string();
}

// Whether something is there that is written to as it is: a device, a pipe, a socket.
bool IsDevice(const std::string& path) {
  struct stat status {};
  return stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
}

void WriteDirectly(const std::string& path, std::string_view bytes) {
  Descriptor file(path, O_WRONLY);
  if (!file.is_open() || !file.Write(bytes) || !file.Close()) FailToWrite(path, errno);
}

}  // namespace

std::string ReadFile(const std::string& path, std::size_t limit) {
  const auto fail = [&] {
    throw Error(fmt::format("{}: cannot be read: {}", path, std::strerror(errno)));
  };
  const Descriptor file(path, O_RDONLY | O_NONBLOCK);  // a pipe without a writer would wait
  if (!file.is_open()) fail();

  struct stat status {};
  if (fstat(file.get(), &status) != 0) fail();
  if (!S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode)) FailAsNoFile(path);
  std::string bytes;
  bytes.reserve(std::min(limit, static_cast<std::size_t>(std::max<off_t>(status.st_size, 0))));

  char buffer[1 << 16];
  while (true) {
    const ssize_t count = read(file.get(), buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail();
    if (count == 0) return bytes;
    bytes.append(buffer, static_cast<std::size_t>(count));
    if (bytes.size() > limit) {
      throw Error(fmt::format("{}: is larger than {} bytes, the most that is read", path, limit));
    }
  }
}

void ExpectFileWritable(const std::string& path) {
  if (path.empty()) throw Error("an empty file name cannot be written");
  const std::string target = FollowLinks(path);
  if (IsDevice(target)) return;
  std::error_code ignored;
  if (std::filesystem::is_directory(target, ignored)) {
    throw Error(fmt::format("{}: cannot be written: is a folder", path));
  }
  const std::filesystem::path folder = std::filesystem::path(target).parent_path();
  if (!folder.empty() && !std::filesystem::is_directory(folder, ignored)) {
    throw Error(fmt::format("{}: cannot be written: its folder is missing", path));
  }
  RemoveAbandonedDrafts(target);
  DraftFile probe(target);
  if (!probe.is_open() || !probe.Sync() || !probe.Remove()) FailToWrite(path, errno);
}

void ExpectRegularFile(const std::string& path) {
  if (IsDevice(path)) FailAsNoFile(path);
}

void MakeFolder(const std::string& path) {
  std::error_code failure;
  std::filesystem::create_directories(path, failure);
  if (failure) throw Error(fmt::format("{}: cannot be made: {}", path, failure.message()));
}

void WriteFileAtomically(const std::string& path, std::string_view bytes) {
  const std::string target = FollowLinks(path);
  if (IsDevice(target)) return WriteDirectly(path, bytes);

  DraftFile draft(target);
  // after the sync nothing is left that closing could say
  if (!draft.is_open() || !draft.Write(bytes) || !draft.Sync() || !draft.Rename()) {
    FailToWrite(path, errno);
  }
  // The rename itself reaches the disk with its folder. Where a file system cannot do that, the
  // file is still complete: after a power cut it is the old or the new one.
  const std::filesystem::path folder = std::filesystem::path(target).parent_path();
  const Descriptor parent(folder.empty() ? "." : folder.string(), O_RDONLY | O_DIRECTORY);
  if (parent.is_open()) fsync(parent.get());
}

}  // namespace physpring

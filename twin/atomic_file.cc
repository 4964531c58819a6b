// SPDX-License-Identifier: Apache-2.0
#include "twin/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "twin/error.h"

namespace physpring {
namespace {

// An open file descriptor, closed when it goes out of scope.
class Descriptor {
 public:
  Descriptor(const std::string& path, int flags)
      : fd_(open(path.c_str(), flags | O_CLOEXEC, 0666)) {}
  ~Descriptor() {
    if (fd_ >= 0) close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  bool is_open() const { return fd_ >= 0; }
  int get() const { return fd_; }

  // Writes everything; false with errno set when that fails.
  bool Write(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t written = write(fd_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return true;
  }

  // Some file systems report a full disk only here.
  bool Close() {
    const int fd = fd_;
    fd_ = -1;
    return close(fd) == 0;
  }

 private:
  int fd_;
};

[[noreturn]] void FailToWrite(const std::string& path, int error) {
  throw Error(fmt::format("{}: cannot be written: {}", path, std::strerror(error)));
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

// A name beside `path` that no other writer, of this process or another, uses.
std::string TemporaryName(const std::string& path) {
  static std::atomic<unsigned> count{0};
  return fmt::format("{}.{}-{}.tmp", path, getpid(), count++);
}

void WriteDirectly(const std::string& path, std::string_view bytes) {
  Descriptor file(path, O_WRONLY);
  if (!file.is_open() || !file.Write(bytes) || !file.Close()) FailToWrite(path, errno);
}

// Writes and syncs a new file; false with errno set when that fails.
bool WriteNewFile(const std::string& path, std::string_view bytes) {
  Descriptor file(path, O_WRONLY | O_CREAT | O_EXCL);
  return file.is_open() && file.Write(bytes) && fsync(file.get()) == 0 && file.Close();
}

}  // namespace

std::string ReadFile(const std::string& path, std::size_t limit) {
  const auto fail = [&] {
    throw Error(fmt::format("{}: cannot be read: {}", path, std::strerror(errno)));
  };
  const Descriptor file(path, O_RDONLY);
  if (!file.is_open()) fail();

  struct stat status {};
  if (fstat(file.get(), &status) != 0) fail();
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
  const std::string temporary = TemporaryName(target);
  if (!WriteNewFile(temporary, "")) FailToWrite(path, errno);
  unlink(temporary.c_str());
}

void WriteFileAtomically(const std::string& path, std::string_view bytes) {
  const std::string target = FollowLinks(path);
  if (IsDevice(target)) return WriteDirectly(path, bytes);

  const std::string temporary = TemporaryName(target);
  if (!WriteNewFile(temporary, bytes) || rename(temporary.c_str(), target.c_str()) != 0) {
    const int error = errno;
    unlink(temporary.c_str());
    FailToWrite(path, error);
  }
  // The rename itself reaches the disk with its folder. Where a file system cannot do that, the
  // file is still complete: after a power cut it is the old or the new one.
  const std::filesystem::path folder = std::filesystem::path(target).parent_path();
  const Descriptor parent(folder.empty() ? "." : folder.string(), O_RDONLY | O_DIRECTORY);
  if (parent.is_open()) fsync(parent.get());
}

}  // namespace physpring

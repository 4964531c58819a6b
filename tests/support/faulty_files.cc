// SPDX-License-Identifier: Apache-2.0
// A library for LD_PRELOAD that lets one call on files fail, as a full or broken disk would. What
// it does is said by the environment:
//   FAULT_FOLDER  only files below it are concerned
//   FAULT_CALL    open, write, fsync, close, rename, mkdir, unlink, link or flock
//   FAULT_AT      the first call of these that fails, from 1 on; 0: none does
//   FAULT_LAST    the last one
//   FAULT_ERROR   the error number; 0: a write takes half of the bytes
//   FAULT_COUNTS  a file that gets a line "CALL COUNT" for each kind of call, at the end
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>

namespace {

constexpr std::array kCalls{"open",  "write",  "fsync", "close", "rename",
                            "mkdir", "unlink", "link",  "flock"};
enum Call { kOpen, kWrite, kFsync, kClose, kRename, kMkdir, kUnlink, kLink, kFlock };

std::array<std::atomic<int>, kCalls.size()> counts;
std::array<std::atomic<bool>, 4096> below;  // by descriptor: a file below the folder

std::string_view Setting(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

int Number(const char* name) { return std::atoi(Setting(name).data()); }

bool IsBelow(const char* path) {
  const std::string_view folder = Setting("FAULT_FOLDER");
  return path && !folder.empty() && std::string_view(path).starts_with(folder);
}

bool IsBelow(int fd) {
  return fd >= 0 && fd < static_cast<int>(below.size()) && below[static_cast<std::size_t>(fd)];
}

void Mark(int fd, bool value) {
  if (fd >= 0 && fd < static_cast<int>(below.size())) below[static_cast<std::size_t>(fd)] = value;
}

// Counts a call that is concerned. Whether it has to fail.
bool Fails(Call call) {
  const int count = ++counts[call];
  if (Setting("FAULT_CALL") != kCalls[call]) return false;
  if (count < Number("FAULT_AT") || count > Number("FAULT_LAST")) return false;
  errno = Number("FAULT_ERROR");
  return true;
}

// The function of this name that the program would have called.
template <class Function>
Function* Real(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

int OpenWith(const char* name, const char* path, int flags, mode_t mode) {
  if (IsBelow(path) && Fails(kOpen)) return -1;
  const int fd = Real<int(const char*, int, ...)>(name)(path, flags, mode);
  Mark(fd, IsBelow(path));
  return fd;
}

// Writes the counts when the program ends.
struct Report {
  ~Report() {
    const std::string_view path = Setting("FAULT_COUNTS");
    if (path.empty()) return;
    std::FILE* file = std::fopen(path.data(), "w");
    if (!file) return;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      std::fprintf(file, "%s %d\n", kCalls[i], counts[i].load());
    }
    std::fclose(file);
  }
} report;

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const auto mode = static_cast<mode_t>(va_arg(rest, unsigned));
  va_end(rest);
  return OpenWith("open", path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const auto mode = static_cast<mode_t>(va_arg(rest, unsigned));
  va_end(rest);
  return OpenWith("open64", path, flags, mode);
}

ssize_t write(int fd, const void* bytes, size_t size) {
  const auto real = Real<ssize_t(int, const void*, size_t)>("write");
  if (!IsBelow(fd) || !Fails(kWrite)) return real(fd, bytes, size);
  return errno != 0 ? -1 : real(fd, bytes, (size + 1) / 2);
}

int fsync(int fd) { return IsBelow(fd) && Fails(kFsync) ? -1 : Real<int(int)>("fsync")(fd); }

int close(int fd) {
  const bool fails = IsBelow(fd) && Fails(kClose);
  const int error = errno;
  Mark(fd, false);
  const int result = Real<int(int)>("close")(fd);
  if (!fails) return result;
  errno = error;
  return -1;
}

int rename(const char* from, const char* to) {
  if (IsBelow(to) && Fails(kRename)) return -1;
  return Real<int(const char*, const char*)>("rename")(from, to);
}

int mkdir(const char* path, mode_t mode) {
  if (IsBelow(path) && Fails(kMkdir)) return -1;
  return Real<int(const char*, mode_t)>("mkdir")(path, mode);
}

char* mkdtemp(char* path) {
  if (IsBelow(path) && Fails(kMkdir)) return nullptr;
  return Real<char*(char*)>("mkdtemp")(path);
}

int unlink(const char* path) {
  if (IsBelow(path) && Fails(kUnlink)) return -1;
  return Real<int(const char*)>("unlink")(path);
}

int remove(const char* path) {
  if (IsBelow(path) && Fails(kUnlink)) return -1;
  return Real<int(const char*)>("remove")(path);
}

int link(const char* from, const char* to) {
  if (IsBelow(to) && Fails(kLink)) return -1;
  return Real<int(const char*, const char*)>("link")(from, to);
}

int flock(int fd, int operation) {
  return IsBelow(fd) && Fails(kFlock) ? -1 : Real<int(int, int)>("flock")(fd, operation);
}

}  // extern "C"

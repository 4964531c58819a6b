// SPDX-License-Identifier: Apache-2.0
#include "twin/draft_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>

namespace physpring {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kTemporary = ".tmp";

// A name that no other draft of this process has.
std::string NewName(const std::string& path, const std::string& ending) {
  static std::atomic<unsigned> count{0};
  return fmt::format("{}.{}-{}{}{}", path, getpid(), count++, kTemporary, ending);
}

bool IsNumber(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

// "film.mp4" of "film.mp4.123-4.tmp" or "film.mp4.123-4.tmp.mp4"; empty if `name` is none of a
// draft.
std::string_view NameOfWhole(std::string_view name) {
  const std::size_t temporary = name.rfind(kTemporary);
  if (temporary == std::string_view::npos) return {};
  const std::string_view ending = name.substr(temporary + kTemporary.size());
  name = name.substr(0, temporary);
  const std::size_t point = name.rfind('.'), dash = name.rfind('-');
  if (point == std::string_view::npos || dash == std::string_view::npos || dash < point) return {};
  const bool numbers =
      IsNumber(name.substr(point + 1, dash - point - 1)) && IsNumber(name.substr(dash + 1));
  const std::string_view whole = name.substr(0, point);
  return numbers && whole.ends_with(ending) ? whole : std::string_view();
}

// Those of one file, or of all if `name` is empty.
void RemoveAbandoned(const fs::path& folder, std::string_view name) {
  std::error_code failure;
  for (fs::directory_iterator entry(folder, failure), end; !failure && entry != end;
       entry.increment(failure)) {
    const std::string draft = entry->path().filename().string();
    const std::string_view whole = NameOfWhole(draft);
    if (whole.empty() || (!name.empty() && whole != name)) continue;
    Descriptor lock;
    if (IsAbandoned(entry->path().string(), &lock)) unlink(entry->path().c_str());
  }
}

}  // namespace

bool IsAbandoned(const std::string& path, Descriptor* lock) {
  *lock = Descriptor(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK);
  return lock->is_open() && lock->TryLock() == Descriptor::Lock::kTaken && lock->IsAt(path);
}

DraftFile::DraftFile(const std::string& path, const std::string& ending) : path_(path) {
  // Between making it and locking it another program may take it for abandoned; then again.
  do {
    name_ = NewName(path, ending);
    file_ = Descriptor(name_, O_WRONLY | O_CREAT | O_EXCL);
  } while (is_open() ? file_.TryLock() == Descriptor::Lock::kHeldByAnother || !file_.HasName()
                     : errno == EEXIST);
}

DraftFile::~DraftFile() { Remove(); }

bool DraftFile::Sync() const { return fsync(file_.get()) == 0; }

bool DraftFile::Rename() {
  if (rename(name_.c_str(), path_.c_str()) != 0) return false;
  file_.Close();
  return true;
}

bool DraftFile::Remove() {
  const int before = errno;
  if (!is_open()) return true;
  const bool removed = unlink(name_.c_str()) == 0;
  file_.Close();
  if (removed) errno = before;
  return removed;
}

void RemoveAbandonedDrafts(const std::string& path) {
  const fs::path whole(path);
  const fs::path folder = whole.parent_path();
  RemoveAbandoned(folder.empty() ? "." : folder, whole.filename().string());
}

void RemoveAbandonedDraftsIn(const std::string& folder) { RemoveAbandoned(folder, ""); }

}  // namespace physpring

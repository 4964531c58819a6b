// SPDX-License-Identifier: Apache-2.0
#include "exporter/folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "twin/atomic_file.h"
#include "twin/descriptor.h"
#include "twin/draft_file.h"
#include "twin/error.h"

namespace physpring {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kRandom = "XXXXXX";

// Begins the names of the drafts of a folder, which are beside it.
std::string DraftPrefix(const fs::path& target) {
  return fmt::format(".{}.export-", target.filename().string());
}

// A new folder beside the one to be written; removed again unless it was renamed. It is locked, so
// that another program does not take it for abandoned.
class DraftFolder {
 public:
  explicit DraftFolder(const fs::path& target) {
    do {  // again where it was taken for that before it was locked
      path_ = (target.parent_path() / (DraftPrefix(target) + std::string(kRandom))).string();
      if (!mkdtemp(path_.data())) {
        throw Error(fmt::format("{}: cannot be made: {}", target.string(), std::strerror(errno)));
      }
      lock_ = Descriptor(path_, O_RDONLY | O_DIRECTORY);
    } while (lock_.is_open() &&
             (lock_.TryLock() == Descriptor::Lock::kHeldByAnother || !lock_.HasName()));
    chmod(path_.c_str(), 0755);  // mkdtemp makes it for its owner alone
  }
  ~DraftFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  DraftFolder(const DraftFolder&) = delete;
  DraftFolder& operator=(const DraftFolder&) = delete;

  fs::path path() const { return path_; }

 private:
  std::string path_;
  Descriptor lock_;
};

// Drafts of this folder whose programs do not live any more.
void RemoveAbandonedDrafts(const fs::path& target) {
  const std::string prefix = DraftPrefix(target);
  std::vector<fs::path> drafts;
  std::error_code failure;
  for (fs::directory_iterator entry(target.parent_path(), failure), end; !failure && entry != end;
       entry.increment(failure)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with(prefix) && name.size() == prefix.size() + kRandom.size()) {
      drafts.push_back(entry->path());
    }
  }
  for (const fs::path& draft : drafts) {
    Descriptor lock;
    if (IsAbandoned(draft.string(), &lock)) fs::remove_all(draft, failure);
  }
}

// Gives new files the places of old ones, and those the places back unless all succeed.
class Replacement {
 public:
  // `from`, `to`: folders with the new and with the old files; old ones wait in `aside`.
  Replacement(fs::path from, fs::path to, fs::path aside)
      : from_(std::move(from)), to_(std::move(to)), aside_(std::move(aside)) {}
  ~Replacement() {
    std::error_code ignored;
    for (const std::string& name : placed_) fs::remove(to_ / name, ignored);
    for (const std::string& name : moved_) fs::rename(aside_ / name, to_ / name, ignored);
  }
  Replacement(const Replacement&) = delete;
  Replacement& operator=(const Replacement&) = delete;

  void Replace(const std::string& name, std::error_code* error) {
    const fs::path old = to_ / name;
    const fs::file_status status = fs::symlink_status(old);
    if (fs::is_directory(status)) *error = std::make_error_code(std::errc::is_a_directory);
    if (*error) return;
    if (fs::exists(status)) {
      fs::create_hard_link(old, aside_ / name, *error);  // so that it is missing at no time
      if (*error)
        TakeAway(name, error);  // a file system without links
      else
        moved_.push_back(name);
    } else {
      placed_.push_back(name);
    }
    if (!*error) fs::rename(from_ / name, old, *error);
  }
  void TakeAway(const std::string& name, std::error_code* error) {
    fs::rename(to_ / name, aside_ / name, *error);
    if (!*error) moved_.push_back(name);
  }
  void Keep() {
    placed_.clear();
    moved_.clear();
  }

 private:
  fs::path from_, to_, aside_;
  std::vector<std::string> placed_, moved_;  // without and with an old file in `aside_`
};

// level0.xml, scene_level12.xml ...
bool IsLevelFile(std::string_view name) {
  constexpr std::string_view kScene = "scene_", kLevel = "level", kEnding = ".xml";
  if (name.starts_with(kScene)) name.remove_prefix(kScene.size());
  if (!name.starts_with(kLevel) || !name.ends_with(kEnding)) return false;
  if (name.size() <= kLevel.size() + kEnding.size()) return false;
  name = name.substr(kLevel.size(), name.size() - kLevel.size() - kEnding.size());
  return name.find_first_not_of("0123456789") == std::string_view::npos;
}

// Levels of an earlier export that `files` does not bring again.
std::vector<std::string> OtherLevels(const fs::path& folder,
                                     const std::map<std::string, std::string>& files) {
  std::vector<std::string> others;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (IsLevelFile(name) && !files.contains(name)) others.push_back(name);
  }
  return others;
}

// The new files, in `draft`, take the places of those of the same names in `target`, or none does.
void ReplaceFiles(const fs::path& draft, const fs::path& target,
                  const std::map<std::string, std::string>& files, std::error_code* error) {
  const fs::path aside = draft / "replaced";
  fs::create_directory(aside, *error);
  Replacement replacement(draft, target, aside);
  for (const auto& [name, content] : files) {
    if (!*error) replacement.Replace(name, error);
  }
  for (const std::string& other : OtherLevels(target, files)) {
    if (!*error) replacement.TakeAway(other, error);
  }
  if (!*error) replacement.Keep();
}

// Writes a file of the draft. A failure is that of the file which it is to become.
void WriteInto(const fs::path& draft, const std::string& name, const std::string& content,
               const fs::path& target) {
  try {
    WriteFileAtomically(draft / name, content);
  } catch (const Error& error) {
    const std::string what = error.what();
    throw Error((target / name).string() + what.substr((draft / name).string().size()));
  }
}

}  // namespace

void WriteFolder(const std::string& path, const std::map<std::string, std::string>& files,
                 bool force) {
  std::error_code error;
  fs::path target = fs::absolute(path).lexically_normal();
  if (!target.has_filename()) target = target.parent_path();  // DIR/
  const bool exists = fs::exists(target, error);
  if (exists && !fs::is_directory(target, error)) {
    throw Error(fmt::format("{}: is not a folder", path));
  }
  const bool empty = !exists || fs::is_empty(target, error);
  if (!empty && !force) throw Error(fmt::format("{}: exists; --force overwrites", path));

  fs::create_directories(target.parent_path(), error);
  RemoveAbandonedDrafts(target);
  const DraftFolder draft(target);
  for (const auto& [name, content] : files) WriteInto(draft.path(), name, content, target);
  if (empty) {
    fs::rename(draft.path(), target, error);
  } else {
    ReplaceFiles(draft.path(), target, files, &error);
  }
  if (error) throw Error(fmt::format("{}: cannot be written: {}", path, error.message()));
}

}  // namespace physpring

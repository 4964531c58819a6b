// SPDX-License-Identifier: Apache-2.0
#include "exporter/folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <set>
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
constexpr std::string_view kSample = "sample_";
constexpr int kSampleDigits = 4;

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

// level0.xml, scene_level12.xml ...
bool IsLevelFile(std::string_view name) {
  constexpr std::string_view kScene = "scene_", kLevel = "level", kEnding = ".xml";
  if (name.starts_with(kScene)) name.remove_prefix(kScene.size());
  if (!name.starts_with(kLevel) || !name.ends_with(kEnding)) return false;
  if (name.size() <= kLevel.size() + kEnding.size()) return false;
  name = name.substr(kLevel.size(), name.size() - kLevel.size() - kEnding.size());
  return name.find_first_not_of("0123456789") == std::string_view::npos;
}

// sample_0007
bool IsNameOfSample(std::string_view name) {
  if (!name.starts_with(kSample) || name.size() < kSample.size() + kSampleDigits) return false;
  name.remove_prefix(kSample.size());
  return name.find_first_not_of("0123456789") == std::string_view::npos;
}

// Whether an export made the folder: there is nothing else in it.
bool IsSampleFolder(const fs::path& folder) {
  if (!IsNameOfSample(folder.filename().string())) return false;
  std::error_code error;
  if (!fs::is_directory(fs::symlink_status(folder, error))) return false;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    const bool ours = name == "README.md" || name == "scene.xml" || IsLevelFile(name);
    if (!ours || !entry->is_regular_file()) return false;
  }
  return !error;
}

// Gives new files the places of old ones, and those the places back unless all succeed.
class Replacement {
 public:
  // `from`, `to`: folders with the new and with the old files; old ones wait in `aside`.
  Replacement(fs::path from, fs::path to, fs::path aside)
      : from_(std::move(from)), to_(std::move(to)), aside_(std::move(aside)) {}
  ~Replacement() {
    std::error_code ignored;
    for (const std::string& name : placed_) fs::remove_all(to_ / name, ignored);
    for (const std::string& name : moved_) {
      // a folder that is there is the new one; a file is replaced by renaming
      if (fs::is_directory(aside_ / name)) fs::remove_all(to_ / name, ignored);
      fs::rename(aside_ / name, to_ / name, ignored);
    }
  }
  Replacement(const Replacement&) = delete;
  Replacement& operator=(const Replacement&) = delete;

  void Replace(const std::string& name, std::error_code* error) {
    const fs::path old = to_ / name;
    const fs::file_status status = fs::symlink_status(old);
    const bool folder = fs::is_directory(from_ / name);
    if (folder && fs::exists(status) && !IsSampleFolder(old)) {
      throw Error(
          fmt::format("{}: is in the way of a sample, and no export made it", old.string()));
    }
    if (!folder && fs::is_directory(status)) {
      *error = std::make_error_code(std::errc::is_a_directory);
      return;
    }
    if (!fs::exists(status)) {
      placed_.push_back(name);
    } else if (folder) {
      TakeAway(name, error);
    } else {
      fs::create_hard_link(old, aside_ / name, *error);  // so that it is missing at no time
      if (*error)
        TakeAway(name, error);  // a file system without links
      else
        moved_.push_back(name);
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

// The first parts of the names of files: what is replaced as a whole.
std::set<std::string> UnitsOf(const std::map<std::string, std::string>& files) {
  std::set<std::string> units;
  for (const auto& [name, content] : files) units.insert(name.substr(0, name.find('/')));
  return units;
}

// Levels and samples of an earlier export that do not come again.
std::vector<std::string> OthersThan(const std::set<std::string>& units, const fs::path& folder) {
  std::vector<std::string> others;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool ours = IsLevelFile(name) || IsSampleFolder(entry.path());
    if (ours && !units.contains(name)) others.push_back(name);
  }
  return others;
}

// The new files, in `draft`, take the places of those of the same names in `target`, or none does.
void ReplaceFiles(const fs::path& draft, const fs::path& target,
                  const std::map<std::string, std::string>& files, std::error_code* error) {
  const fs::path aside = draft / "replaced";
  fs::create_directory(aside, *error);
  Replacement replacement(draft, target, aside);
  const std::set<std::string> units = UnitsOf(files);
  for (const std::string& unit : units) {
    if (!*error) replacement.Replace(unit, error);
  }
  for (const std::string& other : OthersThan(units, target)) {
    if (!*error) replacement.TakeAway(other, error);
  }
  if (!*error) replacement.Keep();
}

// Writes a file of the draft. A failure is that of the file which it is to become.
void WriteInto(const fs::path& draft, const std::string& name, const std::string& content,
               const fs::path& target) {
  try {
    std::error_code ignored;  // the file then cannot be written, which is told
    fs::create_directories((draft / name).parent_path(), ignored);
    WriteFileAtomically(draft / name, content);
  } catch (const Error& error) {
    const std::string what = error.what();
    throw Error((target / name).string() + what.substr((draft / name).string().size()));
  }
}

}  // namespace

std::string SampleFolder(int index) {
  return fmt::format("{}{:0{}}", kSample, index, kSampleDigits);
}

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

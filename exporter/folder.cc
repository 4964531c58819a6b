// SPDX-License-Identifier: Apache-2.0
#include "exporter/folder.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <vector>

#include "twin/atomic_file.h"
#include "twin/error.h"

namespace physpring {
namespace {

namespace fs = std::filesystem;

// A new folder beside the one to be written; removed again unless it was renamed.
class DraftFolder {
 public:
  explicit DraftFolder(const fs::path& target)
      : path_((target.parent_path() / (".export-XXXXXX")).string()) {
    if (!mkdtemp(path_.data())) {
      throw Error(fmt::format("{}: cannot be made: {}", target.string(), std::strerror(errno)));
    }
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
void RemoveOtherLevels(const fs::path& folder, const std::map<std::string, std::string>& files) {
  std::vector<fs::path> others;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (IsLevelFile(name) && !files.contains(name)) others.push_back(entry.path());
  }
  std::error_code ignored;
  for (const fs::path& other : others) fs::remove(other, ignored);
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
  const DraftFolder draft(target);
  for (const auto& [name, content] : files) WriteFileAtomically(draft.path() / name, content);
  if (empty) {
    fs::rename(draft.path(), target, error);
  } else {
    for (const auto& [name, content] : files) {
      if (!error) fs::rename(draft.path() / name, target / name, error);
    }
    if (!error) RemoveOtherLevels(target, files);
  }
  if (error) throw Error(fmt::format("{}: cannot be written: {}", path, error.message()));
}

}  // namespace physpring

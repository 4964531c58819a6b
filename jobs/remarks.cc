// SPDX-License-Identifier: Apache-2.0
#include "jobs/remarks.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

namespace physpring {
namespace {

struct Alike {
  std::string first;            // the file that it is said of first
  std::set<std::string> files;  // all of them
};

}  // namespace

std::vector<std::string> JoinAlike(const std::vector<std::string>& remarks) {
  std::map<std::string, Alike> files;
  std::vector<std::string> order;
  for (const std::string& remark : remarks) {
    const std::size_t colon = std::min(remark.find(": "), remark.size());
    const std::string what = remark.substr(colon);
    const std::string file = remark.substr(0, colon);
    const auto [found, is_new] = files.try_emplace(what, Alike{file, {}});
    if (is_new) order.push_back(what);
    found->second.files.insert(file);
  }
  std::vector<std::string> joined;
  for (const std::string& what : order) {
    const Alike& alike = files[what];
    const std::size_t more = alike.files.size() - 1;
    joined.push_back(more == 0 ? alike.first + what
                               : fmt::format("{} and {} more{}", alike.first, more, what));
  }
  return joined;
}

std::vector<std::string> WarningsOf(std::span<const Recording> recordings) {
  std::vector<std::string> warnings;
  for (const Recording& recording : recordings) {
    warnings.insert(warnings.end(), recording.warnings.begin(), recording.warnings.end());
  }
  return warnings;
}

std::vector<std::string> NotesOf(std::span<const Recording> recordings) {
  std::vector<std::string> notes;
  for (const Recording& recording : recordings) {
    notes.insert(notes.end(), recording.notes.begin(), recording.notes.end());
  }
  return notes;
}

}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
// Files that are written under a name of their own, PATH.<process>-<number>.tmp, and renamed to
// PATH once they are whole. A draft is locked while its program lives. So what a killed program
// left can be told from what another one is writing now, and be removed.
#ifndef PHYSPRING_TWIN_DRAFT_FILE_H_
#define PHYSPRING_TWIN_DRAFT_FILE_H_

#include <string>
#include <string_view>

#include "twin/descriptor.h"

namespace physpring {

class DraftFile {
 public:
  // Makes a new, empty file beside `path`. `ending` follows its name, for a program that goes by
  // it: that of `path`, or nothing.
  explicit DraftFile(const std::string& path, const std::string& ending = "");
  ~DraftFile();  // removes it, unless it has its name
  DraftFile(const DraftFile&) = delete;
  DraftFile& operator=(const DraftFile&) = delete;

  const std::string& name() const { return name_; }

  // All return false, with errno, where they fail.
  bool is_open() const { return file_.is_open(); }
  bool Write(std::string_view bytes) const { return file_.Write(bytes); }
  bool Sync() const;
  bool Rename();  // to `path`
  bool Remove();

 private:
  std::string path_, name_;
  Descriptor file_;
};

// Whether nobody has locked the file or folder at `path`. It stays locked through `lock`. False
// where the file system has no locks.
bool IsAbandoned(const std::string& path, Descriptor* lock);

// Removes the drafts of the file at `path` whose programs do not live any more.
void RemoveAbandonedDrafts(const std::string& path);

// The same for all files in a folder.
void RemoveAbandonedDraftsIn(const std::string& folder);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_DRAFT_FILE_H_

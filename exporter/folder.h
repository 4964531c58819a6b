// SPDX-License-Identifier: Apache-2.0
// A folder of files that is written whole or not at all.
#ifndef PHYSPRING_EXPORTER_FOLDER_H_
#define PHYSPRING_EXPORTER_FOLDER_H_

#include <map>
#include <string>

namespace physpring {

// The folder of a sample of the twin, in that of the fitted one: sample_0007.
std::string SampleFolder(int index);

// Writes all files to a new folder beside `path` and renames it. A name may be that of a file in a
// sample's folder. Where a folder is already, the finished files replace those of the same names in
// it, one by one, and folders of samples those of an earlier export, if `force`; its other levels
// and samples go. Throws Error, and leaves what was there as it was, if that fails, or if there is
// a folder that is not empty and not `force`.
void WriteFolder(const std::string& path, const std::map<std::string, std::string>& files,
                 bool force);

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_FOLDER_H_

// SPDX-License-Identifier: Apache-2.0
// Whole files in one go: reading into memory, and writing so that the file at a path is always the
// old one or the new one, never half of either.
#ifndef PHYSPRING_TWIN_ATOMIC_FILE_H_
#define PHYSPRING_TWIN_ATOMIC_FILE_H_

#include <string>
#include <string_view>

namespace physpring {

// The bytes of a file. Throws Error beginning with the path when it is missing, not readable, a
// folder, a pipe or a device (which may never end), or larger than `limit` bytes.
std::string ReadFile(const std::string& path, std::size_t limit = std::size_t{1} << 32);

// Throws Error beginning with the path if a pipe or a device is there: for files that libraries
// read.
void ExpectRegularFile(const std::string& path);

// Throws Error beginning with the path if WriteFileAtomically could not write there now: for
// finding out before long work. Leaves nothing behind, and removes what killed programs left of
// their temporary files for it (draft_file.h).
void ExpectFileWritable(const std::string& path);

// Makes the folder, and those that it is in, where they are missing. Throws Error beginning with
// the path if that fails.
void MakeFolder(const std::string& path);

// Writes a temporary file in the same folder, syncs it to the disk and renames it. Throws Error
// beginning with the path when that fails (folder missing or not writable, disk full); then a file
// that was there before is untouched and no temporary file is left. Symbolic links are followed.
// What is there but is not a regular file (/dev/stdout, a pipe) is written to directly.
void WriteFileAtomically(const std::string& path, std::string_view bytes);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_ATOMIC_FILE_H_

// SPDX-License-Identifier: Apache-2.0
// Two runs that write to one place would take turns at replacing each other's work. So long work
// holds a lock there: the file OUTPUT.lock, or .lock in an output folder. It is removed at the end.
// The lock is the kernel's (flock), so what a killed run leaves of it keeps nobody out.
#ifndef PHYSPRING_TWIN_OUTPUT_LOCK_H_
#define PHYSPRING_TWIN_OUTPUT_LOCK_H_

#include <string>

#include "twin/descriptor.h"

namespace physpring {

class OutputLock {
 public:
  // Throws Error, beginning with the output, if another run holds the lock of this output, a file
  // or a folder that is there. Devices and pipes have none, and a file system without locks is
  // trusted.
  explicit OutputLock(const std::string& output);
  ~OutputLock();
  OutputLock(const OutputLock&) = delete;
  OutputLock& operator=(const OutputLock&) = delete;

 private:
  std::string path_;
  Descriptor file_;
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_OUTPUT_LOCK_H_

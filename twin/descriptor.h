// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_TWIN_DESCRIPTOR_H_
#define PHYSPRING_TWIN_DESCRIPTOR_H_

#include <string>
#include <string_view>

namespace physpring {

// An open file, or nothing; closed when it goes out of scope. Calls that fail leave errno.
class Descriptor {
 public:
  Descriptor() = default;
  Descriptor(const std::string& path, int flags);  // never inherited by another program
  ~Descriptor() { Close(); }
  Descriptor(Descriptor&& other) noexcept;
  Descriptor& operator=(Descriptor&& other) noexcept;

  bool is_open() const { return fd_ >= 0; }
  int get() const { return fd_; }

  bool Write(std::string_view bytes) const;  // everything, or false
  bool Close();

  // Locks the file against everyone else (flock), without waiting. The lock ends with the last copy
  // of this descriptor: the kernel gives it back when the program ends, however it ends.
  enum class Lock { kTaken, kHeldByAnother, kImpossible };
  Lock TryLock() const;

  bool HasName() const;                      // it was not removed since
  bool IsAt(const std::string& path) const;  // it is what has this name now

 private:
  int fd_ = -1;
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_DESCRIPTOR_H_

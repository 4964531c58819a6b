// SPDX-License-Identifier: Apache-2.0
#include "cli/standard_streams.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace physpring {

void OpenClosedStreams() {
  int opened = 0;
  do {  // the lowest number that is free is the one that is opened
    opened = open("/dev/null", O_RDWR);
  } while (opened >= 0 && opened <= STDERR_FILENO);
  if (opened >= 0) close(opened);
}

std::string WhyNotPrinted() {
  errno = 0;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return "";
  return errno != 0 ? std::strerror(errno) : "an earlier part of it was lost";
}

}  // namespace physpring

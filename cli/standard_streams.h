// SPDX-License-Identifier: Apache-2.0
// Standard input, output and errors as they were handed to the program.
#ifndef PHYSPRING_CLI_STANDARD_STREAMS_H_
#define PHYSPRING_CLI_STANDARD_STREAMS_H_

#include <string>

namespace physpring {

// Opens /dev/null for those that are closed. Else the next file that is opened would take the place
// of one, and a report would be printed into it.
void OpenClosedStreams();

// Why what was printed on standard output has not arrived; empty if it has.
std::string WhyNotPrinted();

}  // namespace physpring

#endif  // PHYSPRING_CLI_STANDARD_STREAMS_H_

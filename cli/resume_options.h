// SPDX-License-Identifier: Apache-2.0
// The options of commands that leave checkpoints: --resume, --force, --checkpoint.
#ifndef PHYSPRING_CLI_RESUME_OPTIONS_H_
#define PHYSPRING_CLI_RESUME_OPTIONS_H_

#include <CLI/CLI.hpp>
#include <string>

namespace physpring {

struct ResumeOptions {
  bool resume = false, force = false;
  double checkpoint_interval = 10;  // s
};

// `resume` and `force` are what the help says of these flags.
void AddResumeOptions(CLI::App* command, ResumeOptions* options, const std::string& resume,
                      const std::string& force);

}  // namespace physpring

#endif  // PHYSPRING_CLI_RESUME_OPTIONS_H_

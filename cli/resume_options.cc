// SPDX-License-Identifier: Apache-2.0
#include "cli/resume_options.h"

#include "cli/option_values.h"

namespace physpring {

void AddResumeOptions(CLI::App* command, ResumeOptions* options, const std::string& resume,
                      const std::string& force) {
  CLI::Option* const resume_flag = command->add_flag("--resume", options->resume, resume);
  command->add_flag("--force", options->force, force)->excludes(resume_flag);
  command
      ->add_option("--checkpoint", options->checkpoint_interval,
                   "seconds between checkpoints, at least")
      ->check(NumberBetween(0, 1e6))
      ->type_name("SECONDS")
      ->capture_default_str();
}

}  // namespace physpring

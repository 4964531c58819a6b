// SPDX-License-Identifier: Apache-2.0
#include "jobs/export.h"

#include <fmt/format.h>

#include <utility>

#include "exporter/export.h"
#include "exporter/folder.h"
#include "report/material_text.h"
#include "twin/error.h"
#include "twin/free_twin.h"

namespace physpring {
namespace {

std::string DescribeLevel(const ExportedLevel& level) {
  const LevelPlan& plan = level.plan;
  const SpringMassSystem& system = plan.system();
  std::string text = fmt::format("{}: {} nodes, {} springs, {} controllers; time step {:.4g} ms",
                                 level.model, system.node_count(), system.spring_count(),
                                 system.controllers, 1e3 * plan.timestep);
  if (plan.substep < plan.timestep) {
    text += fmt::format(" with sub-steps of {:.4g} ms", 1e3 * plan.substep);
  }
  text += fmt::format(", largest stable one {}\n", plan.LargestTimestep());
  for (const std::string& difference : plan.differences) text += "  " + difference + "\n";
  if (plan.springs != SpringKind::kFlex) return text;
  const FlexRounding& rounding = level.flexes.rounding;
  return text + fmt::format(
                    "  {} springs in {} flexes, rounded: stiffness by {:.2g} % (at most {:.2g} %), "
                    "damping by {:.2g} N s/m ({:.2g}), rest length at most {:.2g} mm; {} springs "
                    "stay tendons\n",
                    system.spring_count() - static_cast<int>(level.flexes.tendons.size()),
                    level.flexes.groups.size(), 100 * rounding.stiffness_mean,
                    100 * rounding.stiffness_max, rounding.dashpot_mean, rounding.dashpot_max,
                    1e3 * rounding.rest_length_max, level.flexes.tendons.size());
}

ExportedFolder ExportOne(const Twin& twin, const ExportOptions& options,
                         const std::string& command) {
  const bool free = options.controllers == ControllerKind::kNone;
  const Twin exported = free ? WithoutControllers(twin) : twin;
  Export result = ExportTwin(exported, options, command);
  ExportedFolder folder;
  for (const ExportedLevel& level : result.levels) folder.text += DescribeLevel(level);
  folder.files = std::move(result.files);
  folder.warnings = std::move(result.warnings);
  return folder;
}

std::map<std::string, std::string> FilesOfSample(const Twin& twin, std::uint64_t seed, int index,
                                                 const ExportOptions& options,
                                                 const std::string& command) {
  const Twin sample = SampleOf(twin, seed, index);
  try {
    ExportedFolder folder = ExportOne(sample, options, command);
    folder.files["README.md"] += fmt::format(
        "\nThis is sample {} of seed {}: not the fitted twin, but one drawn from its posterior.\n",
        index, seed);
    return std::move(folder.files);
  } catch (const Error& error) {
    throw Error(fmt::format("sample {}: {}", index, error.what()));
  }
}

}  // namespace

ExportedFolder MakeExport(const Twin& twin, const ExportOptions& options,
                          const std::string& command, const ExportedSamples& samples) {
  ExportedFolder folder = ExportOne(twin, options, command);
  for (int i = 0; i < samples.count; ++i) {
    for (auto& [name, content] : FilesOfSample(twin, samples.seed, i, options, command)) {
      folder.files[SampleFolder(i) + "/" + name] = std::move(content);
    }
  }
  if (samples.count == 0) return folder;
  folder.text += fmt::format("samples of the posterior: {} to {}\n", SampleFolder(0),
                             SampleFolder(samples.count - 1));
  for (std::string& warning : WarningsOfSamples(twin)) {
    folder.warnings.push_back(std::move(warning));
  }
  return folder;
}

std::vector<std::string> WarningsOfSamples(const Twin& twin) {
  if (!twin.material) return {};
  const std::vector<std::string> untold = UntoldOf(*twin.material);
  if (untold.empty()) return {};
  return {
      fmt::format("uncertain by more than a factor of 2: {}; the truth may be further off "
                  "than the samples",
                  fmt::join(untold, ", "))};
}

}  // namespace physpring

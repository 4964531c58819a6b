// SPDX-License-Identifier: Apache-2.0
// physpring fit-splats: pictures of an object -> its splats.
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/option_values.h"
#include "cli/output_files.h"
#include "cli/progress.h"
#include "cli/warnings.h"
#include "pictures/picture_folder.h"
#include "splats/fit/splat_fit.h"
#include "splats/splat_file.h"
#include "twin/error.h"
#include "twin/output_lock.h"

namespace physpring {
namespace {

struct FitSplatsArguments {
  std::string pictures, output;
  std::vector<std::string> cameras;
  bool force = false;
  SplatFitOptions options;
};

SplatFit Fit(const PictureFolder& pictures, SplatFitOptions options) {
  Progress progress(0);
  options.progress = [&](int iteration, double loss) {
    progress.Show(static_cast<double>(iteration) / options.iterations,
                  fmt::format("iteration {}, loss {:.4f}", iteration, loss));
  };
  return UnlessStopped([&] { return FitSplats(pictures, options); });
}

void PrintErrors(const PictureFolder& pictures, const SplatFit& fit) {
  fmt::print("{:<16} {:>6} {:>9} {:>7}\n", "camera", "IoU", "PSNR, dB", "SSIM");
  for (std::size_t i = 0; i < fit.errors.size(); ++i) {
    const std::string& name = pictures.cameras()[i].name;
    if (const std::optional<ImageErrors>& errors = fit.errors[i]) {
      fmt::print("{:<16} {:>6.3f} {:>9.2f} {:>7.4f}\n", name, errors->iou, errors->psnr,
                 errors->ssim);
    } else {
      fmt::print("{:<16} does not see the object\n", name);
    }
  }
}

std::vector<std::string> WarningsOf(const FitSplatsArguments& arguments,
                                    const PictureFolder& pictures, const SplatFit& fit) {
  std::vector<std::string> warnings;
  constexpr double kFew = 0.7, kPoor = 0.9;
  if (fit.splats.count() < kFew * arguments.options.count) {
    warnings.push_back(
        fmt::format("{}: has {} splats, not {}: the object has too few pixels in these pictures",
                    arguments.output, fit.splats.count(), arguments.options.count));
  }
  for (std::size_t i = 0; i < fit.errors.size(); ++i) {
    if (!fit.errors[i] || fit.errors[i]->iou >= kPoor) continue;
    warnings.push_back(fmt::format(
        "{}: only {:.0f} % of what camera {} sees, or would see of the splats, is common: too few "
        "splats or iterations, or a wrong pose or depth",
        arguments.output, 100 * fit.errors[i]->iou, pictures.cameras()[i].name));
  }
  return warnings;
}

void Run(const FitSplatsArguments& arguments) {
  PictureFolder pictures(arguments.pictures);
  ExpectOutputs({arguments.output}, {arguments.pictures});
  const OutputLock lock(arguments.output);
  ExpectNew(arguments.output, arguments.force);
  SplatFitOptions options = arguments.options;
  for (const std::string& name : arguments.cameras) {
    options.cameras.push_back(pictures.CameraOf(name));
  }
  const SplatFit fit = Fit(pictures, options);
  WriteSplats(fit.splats, arguments.output);
  fmt::print("{}: {} splats, {:.2f} mm apart; loss {:.4f} at the start, {:.4f} at the end\n",
             arguments.output, fit.splats.count(), 1e3 * fit.spacing, fit.first_loss, fit.loss);
  PrintErrors(pictures, fit);
  PrintWarnings(WarningsOf(arguments, pictures, fit));
}

}  // namespace

void AddFitSplatsCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "fit-splats",
      "Makes splats (3-D Gaussians) of an object, fitted to what cameras saw of it in one frame.");
  const auto arguments = std::make_shared<FitSplatsArguments>();
  arguments->options.threads = AllCores();
  command
      ->add_option("pictures", arguments->pictures,
                   "folder with cameras.json, as `record --pictures` writes it, with depth")
      ->required()
      ->type_name("DIR");
  command->add_option("-o,--output", arguments->output, "splats to write")
      ->required()
      ->check(FileNameWith(".ply"))
      ->type_name("SPLATS.ply");
  command->add_option("--frame", arguments->options.frame, "that they are fitted to")
      ->check(WholeNumberBetween(0, 1000000))
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--cameras", arguments->cameras,
                   "that they are fitted to; the others are only compared; default: all")
      ->delimiter(',')
      ->type_name("NAME,...");
  command->add_option("--count", arguments->options.count, "about so many splats")
      ->check(WholeNumberBetween(10, 1000000))
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--iterations", arguments->options.iterations, "of the optimiser")
      ->check(WholeNumberBetween(0, 100000))
      ->type_name("N")
      ->capture_default_str();
  AddThreads(command, &arguments->options.threads, "that draw and differentiate");
  command->add_flag("--force", arguments->force, "overwrite a file");
  command->callback([arguments] { Run(*arguments); });
}

}  // namespace physpring

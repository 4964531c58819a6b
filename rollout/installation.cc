// SPDX-License-Identifier: Apache-2.0
#include "rollout/installation.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mujoco/mujoco.h>

#include <array>
#include <cstdlib>
#include <filesystem>

#include "rollout/mujoco_library.h"
#include "rollout/mujoco_log.h"
#include "rollout/osmesa.h"
#include "rollout/plugin_library.h"
#include "twin/error.h"
#include "twin/kernel_choice.h"

namespace physpring {
namespace {

Finding Compiler() {
#ifdef __clang__
  return {"compiler", "Clang " __clang_version__};
#else
  return {"compiler", "GCC " __VERSION__};
#endif
}

// Sets `there` to whether it can be used.
Finding Mujoco(bool* there) {
  // mjVERSION_HEADER is MMMmmmppp
  constexpr int kHeader = mjVERSION_HEADER;
  Finding finding{"MuJoCo", "none"};
  finding.required = true;
  try {
    ExpectMujoco();
  } catch (const Error& error) {
    finding.problem = error.what();
    *there = false;
    return finding;
  }
  *there = true;
  finding.found = fmt::format("{} (headers {}.{}.{}), {}", mj_versionString(), kHeader / 1000000,
                              kHeader / 1000 % 1000, kHeader % 1000, MujocoLibrary().string());
  return finding;
}

std::filesystem::path PluginFolder() {
  if (const char* folder = std::getenv("MUJOCO_PLUGIN_DIR")) return folder;
  const std::filesystem::path library_folder = MujocoLibrary().parent_path();
  const std::filesystem::path release = library_folder.parent_path() / "bin" / "mujoco_plugin";
  return std::filesystem::is_directory(release) ? release : library_folder / "plugin";
}

Finding Plugins() {
  const std::filesystem::path folder = PluginFolder();
  Finding finding{"plugins", ""};
  if (std::filesystem::is_directory(folder)) {
    try {
      CatchMujoco([&] { mj_loadAllPluginLibraries(folder.c_str(), nullptr); });
    } catch (const Error& error) {
      finding.problem = error.what();
    }
  } else {
    finding.problem = folder.string() + " is not a folder; MUJOCO_PLUGIN_DIR can name another";
  }
  try {
    LoadPluginLibrary();  // ours
  } catch (const Error& error) {
    finding.problem += (finding.problem.empty() ? "" : "; ") + std::string(error.what());
  }
  std::vector<std::string> names;
  for (int slot = 0; slot < mjp_pluginCount(); ++slot) {
    names.emplace_back(mjp_getPluginAtSlot(slot)->name);
  }
  finding.found = names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
  return finding;
}

// The version of OpenGL that OSMesa gives a small off-screen context, or empty.
std::string OpenGlVersion(const OsMesa& mesa) {
  if (!mesa.complete()) return "";
  constexpr unsigned kVersion = 0x1F02;  // GL_VERSION
  constexpr int kSize = 4;               // pixels
  const auto get_string = reinterpret_cast<const char* (*)(unsigned)>(mesa.find("glGetString"));
  std::array<unsigned char, 4 * kSize * kSize> pixels{};
  void* context = mesa.create(kGlRgba, 24, 8, 8, nullptr);
  if (!context) return "";
  std::string version;
  if (get_string && mesa.make_current(context, pixels.data(), kGlUnsignedByte, kSize, kSize)) {
    if (const char* text = get_string(kVersion)) version = text;
  }
  mesa.destroy(context);
  return version;
}

Finding OffScreenGl() {
  const OsMesa& mesa = FindOsMesa();
  if (mesa.library.empty()) {
    return {"OSMesa", "not found", "pictures cannot be made; install libosmesa6"};
  }
  const std::string version = OpenGlVersion(mesa);
  if (version.empty()) {
    return {"OSMesa", mesa.library, "gives no OpenGL context; pictures cannot be made"};
  }
  return {"OSMesa", fmt::format("OpenGL {}, {}", version, mesa.library)};
}

Finding SubstepKernel() {
  try {
    return {"sub-steps", fmt::format("kernel {}", BestKernel<double>().name)};
  } catch (const Error& error) {
    return {"sub-steps", "no kernel", error.what(), true};
  }
}

Finding Processor() {
#if defined(__x86_64__)
  const auto word = [](int supported) { return supported ? "yes" : "no"; };
  return {
      "processor",
      fmt::format("x86-64, avx2 {}, fma {}, avx512f {}", word(__builtin_cpu_supports("avx2")),
                  word(__builtin_cpu_supports("fma")), word(__builtin_cpu_supports("avx512f")))};
#else
  return {"processor", "not x86-64"};
#endif
}

}  // namespace

std::vector<Finding> InspectInstallation() {
  std::vector<Finding> findings{{"physpring", PHYSPRING_VERSION}, Compiler()};
  bool mujoco = false;
  findings.push_back(Mujoco(&mujoco));
  if (mujoco) findings.push_back(Plugins());
  findings.insert(findings.end(), {OffScreenGl(), Processor(), SubstepKernel()});
  return findings;
}

}  // namespace physpring

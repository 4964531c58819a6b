// SPDX-License-Identifier: Apache-2.0
#include "rollout/mujoco_library.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <cstdlib>

#include "twin/error.h"

namespace physpring {
namespace {

// mj_version of the process, or null.
void* FindVersion() { return dlsym(RTLD_DEFAULT, "mj_version"); }

// Makes the functions of the library that is named those of the process.
void OpenNamed() {
  static const bool opened = [] {
    const char* const file = std::getenv("PHYSPRING_MUJOCO");
    if (!file || FindVersion()) return true;
    if (dlopen(file, RTLD_NOW | RTLD_GLOBAL)) return true;
    const char* const why = dlerror();
    throw Error(fmt::format("{}: cannot be opened as MuJoCo's library: {}", file,
                            why ? why : "no reason is given"));
  }();
  static_cast<void>(opened);
}

}  // namespace

void ExpectMujoco() {
  OpenNamed();
  if (!FindVersion()) {
    throw Error("MuJoCo is not installed, which this needs: pip install 'physpring[mujoco]'");
  }
  constexpr int kSeries = 1000;  // mjVERSION_HEADER is MMMmmmppp
  if (mj_version() / kSeries == mjVERSION_HEADER / kSeries) return;
  throw Error(
      fmt::format("MuJoCo {} is loaded, but {}.{} is needed: pip install 'mujoco-core~={}.{}.0'",
                  mj_versionString(), mjVERSION_HEADER / 1000000, mjVERSION_HEADER / kSeries % 1000,
                  mjVERSION_HEADER / 1000000, mjVERSION_HEADER / kSeries % 1000));
}

std::filesystem::path MujocoLibrary() {
  Dl_info info;
  void* const version = FindVersion();
  if (!version || dladdr(version, &info) == 0 || !info.dli_fname) return {};
  std::error_code ignored;
  const std::filesystem::path file = std::filesystem::canonical(info.dli_fname, ignored);
  return ignored ? std::filesystem::path(info.dli_fname) : file;
}

}  // namespace physpring

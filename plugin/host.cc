// SPDX-License-Identifier: Apache-2.0
// Finds the functions and stands for them: the plugin calls mj_... as everybody does, and a
// function of that name below hands the call on. The linker refuses a plugin that calls one not
// listed here.
#include "plugin/host.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <link.h>
#include <mujoco/mujoco.h>

#include <cstdarg>
#include <cstdio>
#include <string>
#include <vector>

namespace physpring {
namespace {

struct Functions {
  decltype(&::mj_applyFT) mj_applyFT;
  decltype(&::mj_contactForce) mj_contactForce;
  decltype(&::mj_getPluginConfig) mj_getPluginConfig;
  decltype(&::mj_id2name) mj_id2name;
  decltype(&::mj_jacBodyCom) mj_jacBodyCom;
  decltype(&::mj_objectVelocity) mj_objectVelocity;
  decltype(&::mj_solveM) mj_solveM;
  decltype(&::mj_version) mj_version;
  decltype(&::mjp_defaultPlugin) mjp_defaultPlugin;
  decltype(&::mjp_getPlugin) mjp_getPlugin;
  decltype(&::mjp_getPluginAtSlot) mjp_getPluginAtSlot;
  decltype(&::mjp_registerPlugin) mjp_registerPlugin;
  decltype(&::mju_rotVecQuat) mju_rotVecQuat;
  decltype(&::mju_warning) mju_warning;
};

// Set once, when the library is loaded.
Functions host{};

// `found` is null where `library` (of dlopen) has no such function.
template <class Function>
void Find(void* library, const char* name, Function* found) {
  *found = reinterpret_cast<Function>(dlsym(library, name));
}

Functions FunctionsOf(void* library) {
  Functions of;
  Find(library, "mj_applyFT", &of.mj_applyFT);
  Find(library, "mj_contactForce", &of.mj_contactForce);
  Find(library, "mj_getPluginConfig", &of.mj_getPluginConfig);
  Find(library, "mj_id2name", &of.mj_id2name);
  Find(library, "mj_jacBodyCom", &of.mj_jacBodyCom);
  Find(library, "mj_objectVelocity", &of.mj_objectVelocity);
  Find(library, "mj_solveM", &of.mj_solveM);
  Find(library, "mj_version", &of.mj_version);
  Find(library, "mjp_defaultPlugin", &of.mjp_defaultPlugin);
  Find(library, "mjp_getPlugin", &of.mjp_getPlugin);
  Find(library, "mjp_getPluginAtSlot", &of.mjp_getPluginAtSlot);
  Find(library, "mjp_registerPlugin", &of.mjp_registerPlugin);
  Find(library, "mju_rotVecQuat", &of.mju_rotVecQuat);
  Find(library, "mju_warning", &of.mju_warning);
  return of;
}

// All versions since 2.1 have these two.
bool IsMujoco(const Functions& of) { return of.mj_version && of.mju_warning; }

// mjVERSION_HEADER is MMMmmmppp: 4000001 is 4.0.1. Before 3.5 it had one digit each.
int Base(int version) { return version > 9999 ? 1000 : 10; }

// "4.0"
std::string Series(int version) {
  const int series = version / Base(version);
  return fmt::format("{}.{}", series / Base(version), series % Base(version));
}

bool IsOfOurSeries(const Functions& of) {
  return of.mj_version() / 1000 == mjVERSION_HEADER / 1000;
}

// Paths of the libraries of this process.
std::vector<std::string> LoadedLibraries() {
  std::vector<std::string> paths;
  const auto add = [](dl_phdr_info* info, std::size_t, void* to) {
    static_cast<std::vector<std::string>*>(to)->emplace_back(info->dlpi_name);
    return 0;
  };
  dl_iterate_phdr(add, &paths);
  return paths;
}

// Every MuJoCo of this process, first the one that all libraries see. Python's modules keep theirs
// to themselves, so it is looked for in each library.
std::vector<Functions> LoadedMujocos() {
  std::vector<Functions> all{FunctionsOf(RTLD_DEFAULT)};
  for (const std::string& path : LoadedLibraries()) {
    void* library = dlopen(path.c_str(), RTLD_LAZY | RTLD_NOLOAD);
    if (!library) continue;
    all.push_back(FunctionsOf(library));
    dlclose(library);  // counted, not unloaded
  }
  std::erase_if(all, [](const Functions& of) { return !IsMujoco(of); });
  return all;
}

}  // namespace

bool FindHost() {
  const std::vector<Functions> all = LoadedMujocos();
  if (all.empty()) {
    std::fputs("physpring: no MuJoCo is loaded in this program: the plugins are not registered\n",
               stderr);
    return false;
  }
  for (const Functions& of : all) {
    if (!IsOfOurSeries(of)) continue;
    host = of;
    return true;
  }
  all[0].mju_warning(
      "physpring: this plugin library is for MuJoCo %s, not %s: its plugins are not registered; "
      "build it with that MuJoCo",
      Series(mjVERSION_HEADER).c_str(), Series(all[0].mj_version()).c_str());
  return false;
}

}  // namespace physpring

using physpring::host;

void mj_applyFT(const mjModel* m, mjData* d, const mjtNum force[3], const mjtNum torque[3],
                const mjtNum point[3], int body, mjtNum* qfrc_target) {
  host.mj_applyFT(m, d, force, torque, point, body, qfrc_target);
}

void mj_contactForce(const mjModel* m, const mjData* d, int id, mjtNum result[6]) {
  host.mj_contactForce(m, d, id, result);
}

const char* mj_getPluginConfig(const mjModel* m, int plugin_id, const char* attrib) {
  return host.mj_getPluginConfig(m, plugin_id, attrib);
}

const char* mj_id2name(const mjModel* m, int type, int id) { return host.mj_id2name(m, type, id); }

void mj_jacBodyCom(const mjModel* m, const mjData* d, mjtNum* jacp, mjtNum* jacr, int body) {
  host.mj_jacBodyCom(m, d, jacp, jacr, body);
}

void mj_objectVelocity(const mjModel* m, const mjData* d, int objtype, int objid, mjtNum res[6],
                       int flg_local) {
  host.mj_objectVelocity(m, d, objtype, objid, res, flg_local);
}

void mj_solveM(const mjModel* m, mjData* d, mjtNum* x, const mjtNum* y, int n) {
  host.mj_solveM(m, d, x, y, n);
}

void mjp_defaultPlugin(mjpPlugin* plugin) { host.mjp_defaultPlugin(plugin); }

const mjpPlugin* mjp_getPlugin(const char* name, int* slot) {
  return host.mjp_getPlugin(name, slot);
}

const mjpPlugin* mjp_getPluginAtSlot(int slot) { return host.mjp_getPluginAtSlot(slot); }

int mjp_registerPlugin(const mjpPlugin* plugin) { return host.mjp_registerPlugin(plugin); }

void mju_rotVecQuat(mjtNum res[3], const mjtNum vec[3], const mjtNum quat[4]) {
  host.mju_rotVecQuat(res, vec, quat);
}

void mju_warning(const char* msg, ...) {
  char text[1024];  // as long as MuJoCo's own
  std::va_list arguments;
  va_start(arguments, msg);
  std::vsnprintf(text, sizeof(text), msg, arguments);
  va_end(arguments);
  host.mju_warning("%s", text);
}

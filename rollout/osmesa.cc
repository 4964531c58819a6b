// SPDX-License-Identifier: Apache-2.0
#include "rollout/osmesa.h"

#include <dlfcn.h>

#include <cstdlib>

#ifdef __SANITIZE_ADDRESS__
// Mesa never frees what OSMesaMakeCurrent allocates.
// NOLINTBEGIN(bugprone-reserved-identifier)
extern "C" const char* __lsan_default_suppressions();
const char* __lsan_default_suppressions() { return "leak:libOSMesa"; }
extern "C" const char* __lsan_default_options();
const char* __lsan_default_options() { return "print_suppressions=0"; }
// NOLINTEND(bugprone-reserved-identifier)
#endif

namespace physpring {
namespace {

template <class Function>
void Find(void* library, const char* name, Function* function) {
  *function = reinterpret_cast<Function>(dlsym(library, name));
}

OsMesa Open() {
  OsMesa found;
  for (const char* name : {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"}) {
    // global, because MuJoCo looks up OSMesaGetProcAddress in the process
    void* const library = dlopen(name, RTLD_NOW | RTLD_GLOBAL);  // stays open: it has threads
    if (!library) continue;
    found.library = name;
    Find(library, "OSMesaCreateContextExt", &found.create);
    Find(library, "OSMesaMakeCurrent", &found.make_current);
    Find(library, "OSMesaDestroyContext", &found.destroy);
    Find(library, "OSMesaGetProcAddress", &found.find);
    setenv("MUJOCO_GL", "osmesa", 0);  // whose functions MuJoCo asks for
    break;
  }
  return found;
}

}  // namespace

const OsMesa& FindOsMesa() {
  static const OsMesa found = Open();
  return found;
}

}  // namespace physpring

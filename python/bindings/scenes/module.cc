// SPDX-License-Identifier: Apache-2.0
// The module physpring._scenes: what needs MuJoCo. Its functions are those of the library that the
// process has opened for all (physpring/_mujoco.py), so it is for any 4.0.x.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include "python/bindings/scenes/scenes.h"
#include "rollout/mujoco_library.h"
#include "rollout/plugin_library.h"
#include "rollout/policy.h"
#include "twin/error.h"

NB_MODULE(_scenes, module) {
  namespace nb = nanobind;
  module.doc() = "The part of physpring's engine that needs MuJoCo.";
  nb::register_exception_translator(
      [](const std::exception_ptr& thrown, void*) {
        const nb::object error = nb::module_::import_("physpring._core").attr("Error");
        try {
          std::rethrow_exception(thrown);
        } catch (const physpring::Error& caught) {
          PyErr_SetString(error.ptr(), caught.what());
        } catch (const physpring::PolicyError& caught) {
          PyErr_SetString(error.ptr(), caught.what());
        } catch (const physpring::PolicyServerError& caught) {
          PyErr_SetString(error.ptr(), caught.what());
        }
      },
      nullptr);
  module.def("expect_mujoco", [] { physpring::ExpectMujoco(); });
  module.def("load_plugin", [](const std::string& file) { physpring::LoadPluginLibrary(file); });
  physpring::BindTask(module);
  physpring::BindScene(module);
  physpring::BindSweep(module);
}

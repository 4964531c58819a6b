// SPDX-License-Identifier: Apache-2.0
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <spdlog/spdlog.h>

#include "jobs/remarks.h"
#include "python/bindings/bindings.h"
#include "twin/error.h"
#include "twin/kernel_choice.h"
#include "twin/stop_request.h"

namespace physpring {

namespace nb = nanobind;

void Warn(const std::vector<std::string>& lines) {
  if (lines.empty()) return;
  const nb::object warning = nb::module_::import_("physpring._warnings").attr("PhyspringWarning");
  for (const std::string& line : JoinAlike(lines)) {
    if (PyErr_WarnEx(warning.ptr(), line.c_str(), 1) != 0) throw nb::python_error();
  }
}

}  // namespace physpring

NB_MODULE(_core, module) {
  namespace nb = nanobind;
  module.doc() = "The C++ engine of physpring.";
  module.attr("__version__") = PHYSPRING_VERSION;
  nb::exception<physpring::Error>(module, "Error", PyExc_ValueError).attr("__doc__") =
      "What is wrong, in one line that says where and what is expected.";
  nb::register_exception_translator(
      [](const std::exception_ptr& thrown, void*) {
        try {
          std::rethrow_exception(thrown);
        } catch (const physpring::Stopped&) {  // by another thread's Ctrl-C
          PyErr_SetNone(PyExc_KeyboardInterrupt);
        }
      },
      nullptr);
  module.def(
      "kernel", [] { return std::string(physpring::BestKernel<double>().name); },
      "The instruction set that sub-steps use: 'avx512', 'avx2' or 'scalar'.");
  spdlog::set_level(spdlog::level::off);  // a training's log is for the program
  physpring::BindRecording(module);
  physpring::BindRegistration(module);
  physpring::BindTwin(module);
  physpring::BindSimulator(module);
  physpring::BindTraining(module);
  physpring::BindEvaluation(module);
  physpring::BindTracking(module);
  physpring::BindDiagnosis(module);
  physpring::BindExport(module);
}

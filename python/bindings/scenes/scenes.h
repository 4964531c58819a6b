// SPDX-License-Identifier: Apache-2.0
// The module physpring._scenes: one function for each part of it.
#ifndef PHYSPRING_PYTHON_BINDINGS_SCENES_SCENES_H_
#define PHYSPRING_PYTHON_BINDINGS_SCENES_SCENES_H_

#include <nanobind/nanobind.h>

namespace physpring {

void BindTask(nanobind::module_& module);
void BindScene(nanobind::module_& module);
void BindSweep(nanobind::module_& module);

}  // namespace physpring

#endif  // PHYSPRING_PYTHON_BINDINGS_SCENES_SCENES_H_

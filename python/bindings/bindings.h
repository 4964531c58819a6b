// SPDX-License-Identifier: Apache-2.0
// The module physpring._core: one function for each part of it, and what they share.
#ifndef PHYSPRING_PYTHON_BINDINGS_BINDINGS_H_
#define PHYSPRING_PYTHON_BINDINGS_BINDINGS_H_

#include <nanobind/nanobind.h>

#include <string>
#include <vector>

#include "twin/dataset.h"
#include "twin/npz.h"
#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

// physpring.Recording.
struct GivenRecording {
  RecordingEntry entry;  // where it comes from
  Npz arrays;            // as in its file
  Recording recording;
};

// physpring.Twin.
struct GivenTwin {
  std::string path;  // of its file, or its name
  Twin twin;
};

// The twin, whose levels may have been written to. Throws Error unless they still are levels.
const Twin& Checked(const GivenTwin& given);

// Each line as a Python warning of class physpring.PhyspringWarning. Throws what a filter makes an
// error.
void Warn(const std::vector<std::string>& lines);

void BindRecording(nanobind::module_& module);
void BindRegistration(nanobind::module_& module);
void BindTwin(nanobind::module_& module);
void BindSimulator(nanobind::module_& module);
void BindTraining(nanobind::module_& module);
void BindEvaluation(nanobind::module_& module);
void BindTracking(nanobind::module_& module);
void BindDiagnosis(nanobind::module_& module);
void BindExport(nanobind::module_& module);

}  // namespace physpring

#endif  // PHYSPRING_PYTHON_BINDINGS_BINDINGS_H_

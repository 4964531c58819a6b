// SPDX-License-Identifier: Apache-2.0
// The words for how a twin is exported: in the flags of `physpring export`, and in Python.
#ifndef PHYSPRING_JOBS_EXPORT_WORDS_H_
#define PHYSPRING_JOBS_EXPORT_WORDS_H_

#include "exporter/options.h"
#include "jobs/word.h"

namespace physpring {

inline constexpr Word<SpringKind> kSpringWords[] = {{"auto", SpringKind::kAuto},
                                                    {"tendon", SpringKind::kTendon},
                                                    {"plugin", SpringKind::kPlugin},
                                                    {"flex", SpringKind::kFlex}};

inline constexpr Word<ControllerKind> kControllerWords[] = {{"auto", ControllerKind::kAuto},
                                                            {"mocap", ControllerKind::kMocap},
                                                            {"slide", ControllerKind::kSlide},
                                                            {"none", ControllerKind::kNone}};

inline constexpr Word<ContactKind> kContactWords[] = {{"auto", ContactKind::kAuto},
                                                      {"mujoco", ContactKind::kMujoco},
                                                      {"plugin", ContactKind::kPlugin},
                                                      {"none", ContactKind::kNone}};

}  // namespace physpring

#endif  // PHYSPRING_JOBS_EXPORT_WORDS_H_

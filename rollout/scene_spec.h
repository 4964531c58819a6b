// SPDX-License-Identifier: Apache-2.0
// MJCF as MuJoCo's editable mjSpec.
#ifndef PHYSPRING_ROLLOUT_SCENE_SPEC_H_
#define PHYSPRING_ROLLOUT_SCENE_SPEC_H_

#include <mujoco/mujoco.h>

#include <memory>
#include <string>
#include <vector>

namespace physpring {

struct DeleteSpec {
  void operator()(mjSpec* spec) const { mj_deleteSpec(spec); }
};
using SpecPtr = std::unique_ptr<mjSpec, DeleteSpec>;

// The spec of the file `path`, or of `mjcf`, which `where` stands for in messages. Adds what MuJoCo
// warns of to `warnings`. Throws Error, one line that begins with the file, if it is no MJCF.
SpecPtr ParseSpec(const std::string& path, std::vector<std::string>* warnings);
SpecPtr ParseSpecText(const std::string& mjcf, const std::string& where,
                      std::vector<std::string>* warnings);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_SCENE_SPEC_H_

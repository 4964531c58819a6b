// SPDX-License-Identifier: Apache-2.0
// Some of a level's controllers.
#ifndef PHYSPRING_TWIN_CONTROLLER_MASK_H_
#define PHYSPRING_TWIN_CONTROLLER_MASK_H_

#include <cstddef>
#include <vector>

namespace physpring {

using ControllerMask = std::vector<bool>;  // (controllers); empty: none of them

inline bool Has(const ControllerMask& mask, int controller) {
  return !mask.empty() && mask[static_cast<std::size_t>(controller)];
}

}  // namespace physpring

#endif  // PHYSPRING_TWIN_CONTROLLER_MASK_H_

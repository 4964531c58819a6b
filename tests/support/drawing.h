// SPDX-License-Identifier: Apache-2.0
// Whether this machine can draw pictures: tests that need them are skipped where it cannot.
#ifndef PHYSPRING_TESTS_SUPPORT_DRAWING_H_
#define PHYSPRING_TESTS_SUPPORT_DRAWING_H_

#include <string>

#include "rollout/off_screen.h"
#include "twin/error.h"

namespace physpring {

// Why not; empty: it can.
inline std::string WhyNoDrawing() {
  constexpr int kSize = 16;  // pixels
  try {
    const OffScreen probe(kSize, kSize);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_DRAWING_H_

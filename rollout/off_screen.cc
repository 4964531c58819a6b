// SPDX-License-Identifier: Apache-2.0
#include "rollout/off_screen.h"

#include "rollout/osmesa.h"
#include "twin/error.h"

namespace physpring {
namespace {

const OsMesa& Library() {
  const OsMesa& found = FindOsMesa();
  if (found.library.empty()) {
    throw Error("pictures need OSMesa, which is not here: apt-get install libosmesa6");
  }
  if (!found.complete()) {
    throw Error("pictures need OSMesa, but the library here lacks its functions");
  }
  return found;
}

}  // namespace

OffScreen::OffScreen(int width, int height)
    : pixels_(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
  constexpr int kDepthBits = 24, kStencilBits = 8;
  context_ = Library().create(kGlRgba, kDepthBits, kStencilBits, 0, nullptr);
  if (!context_) throw Error("OSMesa gives no OpenGL context");
  if (!Library().make_current(context_, pixels_.data(), kGlUnsignedByte, width, height)) {
    Library().destroy(context_);
    throw Error("OSMesa's OpenGL context cannot be used");
  }
}

OffScreen::~OffScreen() { Library().destroy(context_); }

}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
#include "rollout/off_screen.h"

#include <dlfcn.h>

#include <cstdlib>

#include "twin/error.h"

namespace physpring {
namespace {

// The functions of libOSMesa that are needed, with the types of GL/osmesa.h.
struct OsMesa {
  void* (*create)(unsigned format, int depth, int stencil, int accumulation, void* shared);
  unsigned char (*make_current)(void* context, void* buffer, unsigned type, int width, int height);
  void (*destroy)(void* context);
};

OsMesa LoadOsMesa() {
  void* library = nullptr;  // stays open: it has threads
  for (const char* name : {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"}) {
    // global, because MuJoCo looks up OSMesaGetProcAddress in the process
    if (!library) library = dlopen(name, RTLD_NOW | RTLD_GLOBAL);
  }
  if (!library) throw Error("pictures need OSMesa, which is not here: apt-get install libosmesa6");
  const OsMesa functions{
      reinterpret_cast<decltype(OsMesa::create)>(dlsym(library, "OSMesaCreateContextExt")),
      reinterpret_cast<decltype(OsMesa::make_current)>(dlsym(library, "OSMesaMakeCurrent")),
      reinterpret_cast<decltype(OsMesa::destroy)>(dlsym(library, "OSMesaDestroyContext"))};
  if (!functions.create || !functions.make_current || !functions.destroy) {
    throw Error("pictures need OSMesa, but the library here lacks its functions");
  }
  setenv("MUJOCO_GL", "osmesa", 0);  // which functions MuJoCo asks for OpenGL's
  return functions;
}

const OsMesa& Library() {
  static const OsMesa functions = LoadOsMesa();
  return functions;
}

}  // namespace

OffScreen::OffScreen(int width, int height)
    : pixels_(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
  constexpr unsigned kRgba = 0x1908, kUnsignedByte = 0x1401;
  constexpr int kDepthBits = 24, kStencilBits = 8;
  context_ = Library().create(kRgba, kDepthBits, kStencilBits, 0, nullptr);
  if (!context_) throw Error("OSMesa gives no OpenGL context");
  if (!Library().make_current(context_, pixels_.data(), kUnsignedByte, width, height)) {
    Library().destroy(context_);
    throw Error("OSMesa's OpenGL context cannot be used");
  }
}

OffScreen::~OffScreen() { Library().destroy(context_); }

}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
// OSMesa, OpenGL in software that draws into memory: opened at run time, so that only pictures need
// it.
#ifndef PHYSPRING_ROLLOUT_OSMESA_H_
#define PHYSPRING_ROLLOUT_OSMESA_H_

#include <string>

namespace physpring {

// The functions of the library that are needed, with the types of GL/osmesa.h; null if it lacks
// one.
struct OsMesa {
  std::string library;  // its name; empty: there is none
  void* (*create)(unsigned format, int depth, int stencil, int accumulation,
                  void* shared) = nullptr;
  unsigned char (*make_current)(void* context, void* buffer, unsigned type, int width,
                                int height) = nullptr;
  void (*destroy)(void* context) = nullptr;
  void* (*find)(const char* function) = nullptr;  // a function of OpenGL

  bool complete() const { return create && make_current && destroy && find; }
};

// OpenGL's names for what a picture is made of.
constexpr unsigned kGlRgba = 0x1908, kGlUnsignedByte = 0x1401;

// Opens the library at the first call, and lets MuJoCo draw with it.
const OsMesa& FindOsMesa();

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_OSMESA_H_

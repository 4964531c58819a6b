// SPDX-License-Identifier: Apache-2.0
// A place to draw without a display: an OpenGL context of OSMesa (Mesa's software renderer). The
// library is looked for when it is first needed, so that programs run without it.
#ifndef PHYSPRING_ROLLOUT_OFF_SCREEN_H_
#define PHYSPRING_ROLLOUT_OFF_SCREEN_H_

#include <vector>

namespace physpring {

// Belongs to the thread that made it, where it is the current context.
class OffScreen {
 public:
  // Throws Error when there is no OSMesa, or it gives no context.
  OffScreen(int width, int height);
  ~OffScreen();
  OffScreen(const OffScreen&) = delete;
  OffScreen& operator=(const OffScreen&) = delete;

 private:
  std::vector<unsigned char> pixels_;
  void* context_ = nullptr;
};

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_OFF_SCREEN_H_

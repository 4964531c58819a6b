// SPDX-License-Identifier: Apache-2.0
// What a camera sees of splats, one by one: ellipses of a colour and an opacity in the picture.
//   t = W p + w,   J = d(u, v) / dt at t,   S2 = J W S W^T J^T + 0.3 I
// (EWA splatting, Zwicker et al. 2001; the 0.3 pixels^2 are the reference implementation's). For J
// alone t.x / t.z and t.y / t.z are kept within 1.3 times the picture.
#ifndef PHYSPRING_SPLATS_PROJECTION_H_
#define PHYSPRING_SPLATS_PROJECTION_H_

#include <Eigen/Core>
#include <vector>

#include "pictures/camera.h"
#include "splats/splats.h"

namespace physpring {

// Nothing nearer is seen, m.
constexpr float kNearest = 0.2F;
// Where a splat is fainter, it is left out.
constexpr float kFaintest = 1.0F / 255;
constexpr float kMostOpaque = 0.99F;
constexpr float kBlur = 0.3F;    // pixels^2
constexpr float kBeyond = 1.3F;  // times half a picture's tangent

struct Ellipse {
  float u = 0, v = 0;                     // its centre, pixels
  float a = 0, b = 0, c = 0;              // of S2^-1: q = (a dx^2 + 2 b dx dy + c dy^2) / 2
  float opacity = 0;                      // at its centre
  float cutoff = 0;                       // where q is larger, it is fainter than kFaintest
  float depth = 0;                        // t.z, m
  float half_width = 0, half_height = 0;  // of the box about q <= cutoff, pixels
  float red = 0, green = 0, blue = 0;     // 0 to about 1
};

// The ellipses of all groups that reach into the picture, sorted by depth; those of one depth as
// the splats are.
std::vector<Ellipse> Project(SplatGroups groups, const PinholeCamera& camera, int threads);

}  // namespace physpring

#endif  // PHYSPRING_SPLATS_PROJECTION_H_

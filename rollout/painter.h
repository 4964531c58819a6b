// SPDX-License-Identifier: Apache-2.0
// Pictures of a MuJoCo scene, drawn off-screen by MuJoCo's classic renderer. One thread's.
#ifndef PHYSPRING_ROLLOUT_PAINTER_H_
#define PHYSPRING_ROLLOUT_PAINTER_H_

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "pictures/image.h"
#include "rollout/off_screen.h"
#include "rollout/splat_layer.h"
#include "twin/points.h"

namespace physpring {

enum class PictureQuality {
  kFast,  // no shadows, reflections or multisampling, round things with few faces
  kHigh,  // what the scene asks for
};

// Sets what the model says about drawing, for pictures of this size. Before any Painter of it.
void PreparePictures(PictureQuality quality, int width, int height, mjModel* model);

// The model's camera of this name. Throws Error, which begins with `scene`, when it has none.
mjvCamera FindCamera(const mjModel& model, const std::string& name, const std::string& scene);

// A camera that sees, obliquely from above, the box from one corner to the other.
mjvCamera OverviewOf(const mjModel& model, const Eigen::Vector3d& low, const Eigen::Vector3d& high);

// Puts everything that is drawn where qpos and the mocap bodies have it.
void PlaceForDrawing(const mjModel& model, mjData* data);

// OpenGL's picture, which begins with the bottom row.
Image FromBottom(const DrawnScene& drawn);

class Painter {
 public:
  // The model and the splats, which are drawn instead of skins (null: there are none), live longer.
  // Throws Error where OSMesa is missing.
  Painter(const mjModel& model, PictureQuality quality, int width, int height,
          const SplatLayer* splats = nullptr);
  ~Painter();
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;

  // The scene as `data` has it, with a small ball at each of `marks` (3 x points, m; a column of
  // NaN has none).
  Image Paint(mjData* data, const mjvCamera& camera, const Points& marks = Points(3, 0));

  // The same as OpenGL has it, with depths, without splats.
  DrawnScene PaintWithDepth(mjData* data, const mjvCamera& camera);

  // Which pixels show what `belongs`, the top row first. `alone`: nothing else is in the way.
  using Belongs = std::function<bool(const mjvGeom&)>;
  std::vector<bool> PixelsOf(const Belongs& belongs, bool alone, mjData* data,
                             const mjvCamera& camera);

 private:
  void Update(mjData* data, const mjvCamera& camera);
  void Mark(const Points& marks);
  DrawnScene Draw(mjData* data, const mjvCamera& camera, const Points& marks, bool with_depth);

  const mjModel& model_;
  const SplatLayer* splats_;
  int width_, height_;
  OffScreen off_screen_;
  mjvOption option_;
  mjvScene scene_;
  mjrContext context_;
};

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_PAINTER_H_

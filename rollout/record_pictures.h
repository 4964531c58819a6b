// SPDX-License-Identifier: Apache-2.0
// What cameras of a scene see of its soft body while it is recorded: a PictureFolder. It is made by
// MuJoCo's renderer of MuJoCo's own body, so nothing of a twin or of splats is in it.
#ifndef PHYSPRING_ROLLOUT_RECORD_PICTURES_H_
#define PHYSPRING_ROLLOUT_RECORD_PICTURES_H_

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "pictures/picture_folder.h"
#include "rollout/painter.h"
#include "rollout/scene.h"
#include "rollout/soft_points.h"

namespace physpring {

struct PictureOptions {
  std::string folder;                // empty: no pictures
  std::vector<std::string> cameras;  // of the scene, which do not move
  int width = 640, height = 480;     // pixels
  PictureQuality quality = PictureQuality::kFast;
};

class PictureRecorder {
 public:
  // `model` has been made ready by PreparePictures; it and `soft` live longer. Throws Error where
  // OSMesa is missing, and for cameras that `scene` does not have, that move or
  // have no perspective.
  PictureRecorder(const mjModel& model, const SoftPoints& soft, const PictureOptions& options,
                  const std::string& scene);

  ~PictureRecorder();  // without Finish: removes what it has written
  PictureRecorder(const PictureRecorder&) = delete;
  PictureRecorder& operator=(const PictureRecorder&) = delete;

  // Writes what all cameras see. `data` is placed for drawing.
  void Record(int frame, const mjData& data);

  // Writes what there is to know of `frames` pictures at `fps`.
  void Finish(double fps, int frames);

 private:
  Mask MaskOf(const mjvCamera& camera);
  PictureFolder Folder(double fps, int frames) const;

  const mjModel& model_;
  const SoftPoints& soft_;
  PictureOptions options_;
  Painter painter_;
  DataPtr data_;
  std::vector<mjvCamera> cameras_;
  std::vector<RecordedCamera> recorded_;
  std::vector<bool> is_body_;  // of the soft body
  int begun_ = 0;              // frames of which there may be pictures
  bool finished_ = false;
};

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_RECORD_PICTURES_H_

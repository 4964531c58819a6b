// SPDX-License-Identifier: Apache-2.0
// From where a recording is looked at: an orthographic camera that shows most of the motion.
//
// The upright frame of a view has x to the right, y away from the viewer and z up (against
// gravity). Its origin is in the middle of what was measured. The horizontal direction in which the
// points spread most lies across the picture; the camera looks down by the elevation.
#ifndef PHYSPRING_REPORT_PICTURE_VIEW_H_
#define PHYSPRING_REPORT_PICTURE_VIEW_H_

#include "twin/recording.h"

namespace physpring {

class View {
 public:
  explicit View(const Recording& recording);

  // The points in the upright frame: 3 x points, m.
  Points ToUpright(const Points& points) const;

  // Where upright points lie in the picture: 2 x points, m, to the right and up.
  Eigen::Matrix2Xd Project(const Points& upright) const;

  // The least and the greatest coordinates of the measured points and the controllers in all
  // frames, upright, m.
  const Eigen::Vector3d& low() const { return low_; }
  const Eigen::Vector3d& high() const { return high_; }
  double elevation() const { return elevation_; }  // rad

 private:
  Eigen::Matrix3d axes_;  // its rows are the upright axes
  Eigen::Vector3d centre_;
  Eigen::Vector3d low_, high_;
  double elevation_;
};

// Lines of a grid on the recording's ground, below what was measured: pairs of upright points
// (3 x 2 lines, m). Empty without ground, or if the ground is steep or far below.
Points GroundGrid(const Recording& recording, const View& view);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_PICTURE_VIEW_H_

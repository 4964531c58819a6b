// SPDX-License-Identifier: Apache-2.0
// A still picture (SVG) of a body: its springs, with room for what is drawn besides, a bar that
// gives the scale, and the world's axes as they lie in the picture.
#ifndef PHYSPRING_REPORT_PICTURE_BODY_PANEL_H_
#define PHYSPRING_REPORT_PICTURE_BODY_PANEL_H_

#include <string>

#include "report/picture/view.h"
#include "twin/spring_mass_system.h"

namespace physpring {

class BodyPanel {
 public:
  // Shows all of `points` (3 x at least 1, m), `width` px wide.
  BodyPanel(const View& view, const Points& points, double width);

  double width() const { return width_; }
  double height() const { return height_; }
  Eigen::Vector2d Pixel(const Eigen::Vector3d& point) const;
  // How a vector lies in the picture: of its length, where it lies across the line of sight.
  Eigen::Vector2d Across(const Eigen::Vector3d& vector) const;

  std::string Springs(const SpringMassSystem& system) const;
  std::string Controllers(const SpringMassSystem& system) const;
  std::string ScaleBar() const;  // at the bottom right
  std::string Axes() const;      // at the bottom left
  std::string Arrow(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                    const std::string& css_class) const;
  // <svg> around the content.
  std::string Wrap(const std::string& content, const std::string& title) const;

 private:
  const View& view_;
  Eigen::Vector2d low_;
  double width_, height_, scale_;  // px, px, px/m
};

}  // namespace physpring

#endif  // PHYSPRING_REPORT_PICTURE_BODY_PANEL_H_

// SPDX-License-Identifier: Apache-2.0
#include "report/picture/body_panel.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "report/picture/nice_step.h"

namespace physpring {
namespace {

constexpr double kSide = 54, kAbove = 34, kBelow = 58;   // px around what is shown
constexpr double kLeastHeight = 190, kMostHeight = 360;  // px
constexpr double kAxisLength = 24;                       // px

}  // namespace

BodyPanel::BodyPanel(const View& view, const Points& points, double width)
    : view_(view), width_(width) {
  const Eigen::Matrix2Xd picture = view.Project(view.ToUpright(points));
  low_ = picture.rowwise().minCoeff();
  const Eigen::Vector2d size = (picture.rowwise().maxCoeff() - low_).array() + 1e-6;
  const double room = kMostHeight - kAbove - kBelow;
  scale_ = std::min((width - 2 * kSide) / size.x(), room / size.y());
  const double tall = std::max(scale_ * size.y(), kLeastHeight - kAbove - kBelow);
  height_ = tall + kAbove + kBelow;
  // in the middle
  low_.x() -= (width / scale_ - size.x()) / 2;
  low_.y() -= (tall / scale_ - size.y()) / 2;
}

Eigen::Vector2d BodyPanel::Pixel(const Eigen::Vector3d& point) const {
  const Eigen::Vector2d at = scale_ * (view_.Project(view_.ToUpright(point)).col(0) - low_);
  return {at.x(), height_ - kBelow - at.y()};
}

Eigen::Vector2d BodyPanel::Across(const Eigen::Vector3d& vector) const {
  Points ends(3, 2);
  ends << Eigen::Vector3d::Zero(), vector;
  const Eigen::Matrix2Xd picture = view_.Project(view_.ToUpright(ends));
  return {picture(0, 1) - picture(0, 0), picture(1, 0) - picture(1, 1)};
}

std::string BodyPanel::Springs(const SpringMassSystem& system) const {
  std::string path;
  for (const auto& [a, b] : system.springs) {
    const Eigen::Vector2d p = Pixel(system.position.col(a)), q = Pixel(system.position.col(b));
    fmt::format_to(std::back_inserter(path), "M{:.1f} {:.1f}L{:.1f} {:.1f}", p.x(), p.y(), q.x(),
                   q.y());
  }
  // the more springs, the fainter each
  const double density = static_cast<double>(system.springs.size()) / width_ / height_;
  return fmt::format("<path class=\"spring\" style=\"opacity:{:.2f}\" d=\"{}\"/>",
                     std::clamp(0.002 / density, 0.1, 0.5), path);
}

std::string BodyPanel::Controllers(const SpringMassSystem& system) const {
  std::string path;
  for (int i = 0; i < system.controllers; ++i) {
    const Eigen::Vector2d at = Pixel(system.position.col(system.node_count() + i));
    fmt::format_to(std::back_inserter(path), "M{:.1f} {:.1f}h0", at.x(), at.y());
  }
  return fmt::format("<path class=\"controller\" stroke-width=\"6\" d=\"{}\"/>", path);
}

std::string BodyPanel::ScaleBar() const {
  const double length = NiceStep(0.1 * width_ / scale_);
  const std::string text =
      length < 1 ? fmt::format("{:g} mm", length * 1e3) : fmt::format("{:g} m", length);
  const double x = width_ - 14, y = height_ - 14;
  return fmt::format(
      "<path class=\"scale\" d=\"M{:.1f} {:.1f}h{:.1f}\"/>"
      "<text text-anchor=\"end\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>",
      x, y, -length * scale_, x, y - 6, text);
}

std::string BodyPanel::Axes() const {
  const Eigen::Vector2d origin(kSide - 14, height_ - 26);
  std::string svg;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector2d along = Across(Eigen::Vector3d::Unit(axis));
    if (along.norm() < 0.3) continue;  // into the picture
    const Eigen::Vector2d end = origin + kAxisLength * along;
    const Eigen::Vector2d name = origin + (kAxisLength + 9) * along.stableNormalized();
    svg += fmt::format(
        "<path class=\"scale\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>"
        "<text text-anchor=\"middle\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>",
        origin.x(), origin.y(), end.x(), end.y(), name.x(), name.y() + 4, "xyz"[axis]);
  }
  return svg;
}

std::string BodyPanel::Arrow(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                             const std::string& css_class) const {
  const Eigen::Vector2d along = (to - from).stableNormalized(), side(-along.y(), along.x());
  const double head = std::min(9.0, 0.5 * (to - from).norm());
  const Eigen::Vector2d p = to - head * along + 0.45 * head * side;
  const Eigen::Vector2d q = to - head * along - 0.45 * head * side;
  return fmt::format(
      "<path class=\"{}\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} "
      "{:.1f}\"/>",
      css_class, from.x(), from.y(), to.x(), to.y(), p.x(), p.y(), to.x(), to.y(), q.x(), q.y());
}

std::string BodyPanel::Wrap(const std::string& content, const std::string& title) const {
  return fmt::format(
      "<svg class=\"body\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\">{}</svg>\n",
      width_, height_, title, content);
}

}  // namespace physpring

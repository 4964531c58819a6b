// SPDX-License-Identifier: Apache-2.0
#include "report/picture/overlay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "report/picture/nice_step.h"

namespace physpring {
namespace {

constexpr int kPanels = 6;
constexpr double kPadding = 14;  // px

// Where pictured metres go on a panel, px.
struct Panel {
  Eigen::Vector2d low;  // m
  double scale;         // px / m
  double width, height;

  // A point far off the panel is brought nearer: it is not seen either way.
  Eigen::Vector2d Pixel(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d pixel(kPadding + (p.x() - low.x()) * scale,
                                height - kPadding - (p.y() - low.y()) * scale);
    return pixel.cwiseMax(-9999.0).cwiseMin(9999.0);
  }
};

// All panels show the measured points and controllers of all frames, and the predicted ones as far
// as they stay near those.
Panel FitPanel(const EvaluatedRecording& evaluated, const View& view) {
  const Eigen::Vector3d margin =
      Eigen::Vector3d::Constant(0.15 * (view.high() - view.low()).norm());
  Eigen::Array2d low = Eigen::Array2d::Constant(1e9), high = -low;
  const auto include = [&](const Points& upright) {
    for (Eigen::Index i = 0; i < upright.cols(); ++i) {
      if (!upright.col(i).allFinite()) continue;
      const Eigen::Vector3d near =
          upright.col(i).cwiseMax(view.low() - margin).cwiseMin(view.high() + margin);
      const Eigen::Vector2d p = view.Project(near);
      low = low.min(p.array());
      high = high.max(p.array());
    }
  };
  for (const Points& frame : evaluated.recording.points) include(view.ToUpright(frame));
  for (const Points& frame : evaluated.recording.controllers) include(view.ToUpright(frame));
  for (const Points& frame : evaluated.result.levels[0].positions) include(view.ToUpright(frame));

  const Eigen::Array2d size = (high - low).max(1e-6);
  // tall bodies stand six in a row, others three
  const double width = size.y() > 1.3 * size.x() ? 168 : 340;
  const double height = std::clamp(width * size.y() / size.x(), 110.0, 330.0);
  const double scale =
      std::min((width - 2 * kPadding) / size.x(), (height - 2 * kPadding) / size.y());
  // what is left over is split on both sides
  const Eigen::Array2d shown = (Eigen::Array2d(width, height) - 2 * kPadding) / scale;
  return {(low + high) / 2 - shown / 2, scale, width, height};
}

// Path data of lines between pairs of pixels, or of dots where both are the same.
void AddLine(const Eigen::Vector2d& from, const Eigen::Vector2d& to, std::string* path) {
  fmt::format_to(std::back_inserter(*path), "M{:.1f} {:.1f}L{:.1f} {:.1f}", from.x(), from.y(),
                 to.x(), to.y());
}

void AddDot(const Eigen::Vector2d& at, std::string* path) {
  fmt::format_to(std::back_inserter(*path), "M{:.1f} {:.1f}h0", at.x(), at.y());
}

std::string FormatGrid(const EvaluatedRecording& evaluated, const View& view, const Panel& panel) {
  const Eigen::Matrix2Xd ends = view.Project(GroundGrid(evaluated.recording, view));
  std::string path;
  for (Eigen::Index i = 0; i + 1 < ends.cols(); i += 2) {
    AddLine(panel.Pixel(ends.col(i)), panel.Pixel(ends.col(i + 1)), &path);
  }
  return fmt::format("<path class=\"ground\" d=\"{}\"/>", path);
}

std::string FormatSprings(const SpringMassSystem& system, const Eigen::Matrix2Xd& columns,
                          const Panel& panel) {
  std::string path;
  for (const auto& [a, b] : system.springs) {
    AddLine(panel.Pixel(columns.col(a)), panel.Pixel(columns.col(b)), &path);
  }
  // the more springs, the fainter each
  const double density = static_cast<double>(system.springs.size()) / panel.width / panel.height;
  const double opacity = std::clamp(0.002 / density, 0.12, 0.5);
  return fmt::format("<path class=\"spring\" style=\"opacity:{:.2f}\" d=\"{}\"/>", opacity, path);
}

// The bar that gives the scale, about a quarter of the panel.
std::string FormatScaleBar(const Panel& panel) {
  const double length = NiceStep(0.13 * panel.width / panel.scale);
  const double x = kPadding, y = panel.height - 6;
  const std::string text =
      length < 1 ? fmt::format("{:g} mm", length * 1e3) : fmt::format("{:g} m", length);
  return fmt::format(
      "<path class=\"scale\" d=\"M{:.1f} {:.1f}h{:.1f}\"/>"
      "<text class=\"scale\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>",
      x, y, length * panel.scale, x + length * panel.scale + 5, y + 3, text);
}

std::string FormatFrame(const EvaluatedRecording& evaluated, const Twin& twin, const View& view,
                        const Panel& panel, int frame) {
  const Recording& recording = evaluated.recording;
  const LevelResult& level = evaluated.result.levels[0];
  const SpringMassSystem& system = twin.levels[0].system;
  Points columns(3, system.position.cols());
  columns.leftCols(system.node_count()) = level.positions[frame];
  if (system.controllers > 0) {
    columns.rightCols(system.controllers) = recording.controllers[frame];
  }
  const Eigen::Matrix2Xd predicted = view.Project(view.ToUpright(columns));
  const Eigen::Matrix2Xd measured = view.Project(view.ToUpright(recording.points[frame]));

  std::string svg = FormatGrid(evaluated, view, panel) + FormatSprings(system, predicted, panel);
  std::string errors, dots, controllers;
  for (Eigen::Index i = 0; i < measured.cols(); ++i) {
    if (!measured.col(i).allFinite()) continue;
    AddLine(panel.Pixel(measured.col(i)), panel.Pixel(predicted.col(i)), &errors);
    AddDot(panel.Pixel(measured.col(i)), &dots);
  }
  for (Eigen::Index i = system.node_count(); i < predicted.cols(); ++i) {
    AddDot(panel.Pixel(predicted.col(i)), &controllers);
  }
  const double size = std::clamp(22 / std::sqrt(measured.cols() + 1.0), 2.2, 6.0);
  return svg + fmt::format(
                   "<path class=\"error\" d=\"{}\"/>"
                   "<path class=\"measured\" stroke-width=\"{:.1f}\" d=\"{}\"/>"
                   "<path class=\"controller\" stroke-width=\"{:.1f}\" d=\"{}\"/>",
                   errors, size, dots, std::max(size, 3.5), controllers);
}

std::string FormatCaption(const EvaluatedRecording& evaluated, int frame) {
  const double error = evaluated.result.levels[0].lifted.track[frame];
  return fmt::format("<b>{:.2f} s</b> {}{}", frame / evaluated.recording.fps,
                     frame < evaluated.result.first_predicted ? "fit" : "prediction",
                     std::isnan(error) ? "" : fmt::format(", track {:.1f} mm", 1e3 * error));
}

}  // namespace

std::string FormatOverlay(const EvaluatedRecording& evaluated, const Twin& twin, const View& view) {
  const Panel panel = FitPanel(evaluated, view);
  std::string html = fmt::format("<div class=\"frames{}\">\n", panel.width < 300 ? " tall" : "");
  for (int k = 1; k <= kPanels; ++k) {
    const int frame = k * (evaluated.recording.frame_count() - 1) / kPanels;
    html += fmt::format(
        "<figure><svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\">{}{}</svg>"
        "<figcaption>{}</figcaption></figure>\n",
        panel.width, panel.height, FormatFrame(evaluated, twin, view, panel, frame),
        k == 1 ? FormatScaleBar(panel) : "", FormatCaption(evaluated, frame));
  }
  return html + "</div>\n";
}

}  // namespace physpring

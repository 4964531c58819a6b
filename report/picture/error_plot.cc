// SPDX-License-Identifier: Apache-2.0
#include "report/picture/error_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <ranges>
#include <vector>

#include "report/picture/nice_step.h"

namespace physpring {
namespace {

constexpr double kWidth = 1040, kHeight = 250;                        // px
constexpr double kLeft = 46, kRight = 944, kTop = 18, kBottom = 216;  // the axes' ends, px

struct Curve {
  std::string label, css_class;
  const std::vector<double>* errors;  // m
};

std::vector<Curve> CurvesOf(const RecordingResult& result) {
  std::vector<Curve> curves;
  for (const BaselineResult& baseline : result.baselines) {
    curves.push_back({baseline.name, "still", &baseline.errors.track});
  }
  for (const LevelResult& level : std::views::reverse(result.levels)) {
    curves.push_back({fmt::format("level {}", level.level),
                      fmt::format("level{}", std::min(level.level, 3)), &level.lifted.track});
  }
  return curves;
}

// Where times and errors go, px.
struct Axes {
  double duration;         // s
  double lowest, highest;  // log10 of the errors in mm

  double X(double seconds) const { return kLeft + (kRight - kLeft) * seconds / duration; }
  double Y(double metres) const {
    const double value = std::log10(std::max(1e3 * metres, 1e-9));
    return kBottom - (kBottom - kTop) * std::max(0.0, value - lowest) / (highest - lowest);
  }
};

// The axes go from a little below the least error that is usual to the greatest. Errors near zero,
// as in the first frames of a perfect start, run along the bottom.
Axes FitAxes(const std::vector<Curve>& curves, double duration) {
  std::vector<double> values;
  for (const Curve& curve : curves) {
    for (std::size_t t = 1; t < curve.errors->size(); ++t) {
      const double millimetres = 1e3 * (*curve.errors)[t];
      if (millimetres > 1e-6) values.push_back(std::log10(millimetres));
    }
  }
  if (values.empty()) return {duration, 0, 0};
  std::sort(values.begin(), values.end());
  const double low = values[values.size() / 20], high = values.back();
  return {duration, std::max(low - 0.15, high - 4.5), std::max(high + 0.05, low + 0.5)};
}

std::string FormatTicks(const Axes& axes) {
  std::string svg;
  const auto out = std::back_inserter(svg);
  for (int decade = -9; decade < 9; ++decade) {
    for (int digit : {1, 2, 5}) {
      const double millimetres = digit * std::pow(10, decade);
      const double value = std::log10(millimetres);
      if (value < axes.lowest || value > axes.highest) continue;
      if (digit != 1 && axes.highest - axes.lowest > 2) continue;
      const double y = axes.Y(1e-3 * millimetres);
      fmt::format_to(out,
                     "<path class=\"grid\" d=\"M{} {:.1f}H{}\"/>"
                     "<text class=\"tick\" text-anchor=\"end\" x=\"{}\" y=\"{:.1f}\">{:g}</text>",
                     kLeft, y, kRight, kLeft - 7, y + 4, millimetres);
    }
  }
  const double step = NiceStep(axes.duration / 10);
  for (double t = 0; t < axes.duration * (1 + 1e-9); t += step) {
    fmt::format_to(out,
                   "<path class=\"axis\" d=\"M{:.1f} {}v4\"/>"
                   "<text class=\"tick\" text-anchor=\"middle\" x=\"{:.1f}\" y=\"{}\">{:g}</text>",
                   axes.X(t), kBottom, axes.X(t), kBottom + 17, t);
  }
  fmt::format_to(out,
                 "<path class=\"axis\" d=\"M{} {}H{}\"/>"
                 "<text class=\"tick\" x=\"{}\" y=\"{}\">mm</text>"
                 "<text class=\"tick\" text-anchor=\"end\" x=\"{}\" y=\"{}\">time, s</text>",
                 kLeft, kBottom, kRight, 8, kTop - 5, kRight, kBottom + 31);
  return svg;
}

// Shades the fitted frames, from 0 to `split` s; names both parts.
std::string FormatSplit(const Axes& axes, double split) {
  const double x = axes.X(split);
  std::string svg = fmt::format(
      "<rect class=\"fit\" x=\"{}\" y=\"{}\" width=\"{:.1f}\" height=\"{}\"/>"
      "<text class=\"part\" text-anchor=\"end\" x=\"{:.1f}\" y=\"{}\">fit</text>",
      kLeft, kTop, x - kLeft, kBottom - kTop, x - 6, kTop - 5);
  if (split < axes.duration) {
    svg += fmt::format("<text class=\"part\" x=\"{:.1f}\" y=\"{}\">prediction</text>", x + 6,
                       kTop - 5);
  }
  return svg;
}

// A frame without data breaks the line.
std::string FormatCurve(const Curve& curve, const Axes& axes, double fps) {
  std::string path;
  bool pen_down = false;
  for (std::size_t t = 0; t < curve.errors->size(); ++t) {
    const double error = (*curve.errors)[t];
    if (!std::isnan(error)) {
      fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}", pen_down ? "L" : "M",
                     axes.X(static_cast<double>(t) / fps), axes.Y(error));
    }
    pen_down = !std::isnan(error);
  }
  return fmt::format("<path class=\"curve {}\" d=\"{}\"/>", curve.css_class, path);
}

// Names at the right ends of the curves, at least a line apart.
std::string FormatLabels(const std::vector<Curve>& curves, const Axes& axes) {
  struct Label {
    double y;
    const Curve* curve;
  };
  std::vector<Label> labels;
  for (const Curve& curve : curves) {
    double y = kBottom;
    for (double error : *curve.errors) y = std::isnan(error) ? y : axes.Y(error);
    labels.push_back({y, &curve});
  }
  std::sort(labels.begin(), labels.end(), [](const Label& a, const Label& b) { return a.y < b.y; });
  constexpr double kLine = 15;
  double lowest = kBottom + kLine;
  for (Label& label : std::views::reverse(labels)) {
    label.y = std::min(label.y, lowest - kLine);
    lowest = label.y;
  }
  std::string svg;
  for (const Label& label : labels) {
    svg += fmt::format("<text class=\"label {}\" x=\"{}\" y=\"{:.1f}\">{}</text>",
                       label.curve->css_class, kRight + 8, label.y + 4, label.curve->label);
  }
  return svg;
}

}  // namespace

std::string FormatErrorPlot(const EvaluatedRecording& evaluated) {
  const double fps = evaluated.recording.fps;
  const std::vector<Curve> curves = CurvesOf(evaluated.result);
  const Axes axes = FitAxes(curves, (evaluated.recording.frame_count() - 1) / fps);
  if (axes.lowest == axes.highest) return "<p>No point is seen after frame 0.</p>\n";
  std::string svg = fmt::format(
      "<svg class=\"plot\" viewBox=\"0 0 {} {}\" data-left=\"{}\" data-right=\"{}\" role=\"img\" "
      "aria-label=\"Track error over time\">",
      kWidth, kHeight, kLeft, kRight);
  if (evaluated.result.trained_on) {
    const int last = evaluated.recording.frame_count() - 1;
    svg += FormatSplit(axes, std::min(evaluated.result.first_predicted - 0.5, 1.0 * last) / fps);
  }
  svg += FormatTicks(axes);
  for (const Curve& curve : curves) svg += FormatCurve(curve, axes, fps);
  svg += FormatLabels(curves, axes);
  return svg + fmt::format(
                   "<line class=\"cursor\" x1=\"{0}\" x2=\"{0}\" y1=\"{1}\" y2=\"{2}\"/>"
                   "</svg>\n",
                   kLeft, kTop, kBottom);
}

}  // namespace physpring

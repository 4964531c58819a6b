// SPDX-License-Identifier: Apache-2.0
#include "report/picture/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "report/picture/nice_step.h"

namespace physpring {
namespace {

// Around the axes, px: room for the ticks' numbers and the labels.
constexpr double kPlotLeft = 58, kPlotRight = 14, kPlotTop = 26, kPlotBottom = 44;

// Where values go, px.
struct PlotAxes {
  double left, right, top, bottom;      // px
  double x_low, x_high, y_low, y_high;  // in units of the plot

  bool IsEmpty() const { return !(x_high > x_low && y_high > y_low); }
  double X(double x) const { return left + (right - left) * (x - x_low) / (x_high - x_low); }
  double Y(double y) const { return bottom - (bottom - top) * (y - y_low) / (y_high - y_low); }
};

PlotAxes FitPlotAxes(const Plot& plot) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  PlotAxes axes{kPlotLeft, plot.width - kPlotRight,
                kPlotTop,  plot.height - kPlotBottom,
                kInfinity, -kInfinity,
                0,         0};
  const auto include = [&](double y) {
    if (!std::isfinite(y)) return;
    axes.y_low = std::min(axes.y_low, y);
    axes.y_high = std::max(axes.y_high, y);
  };
  for (const Plot::Curve& curve : plot.curves) {
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      axes.x_low = std::min(axes.x_low, curve.x[i]);
      axes.x_high = std::max(axes.x_high, curve.x[i]);
      const double error = curve.error.empty() ? 0 : curve.error[i];
      include(curve.y[i] - error);
      include(curve.y[i] + error);
    }
  }
  for (const Plot::Line& line : plot.lines) include(line.y);
  const double margin = 0.04 * (axes.y_high - axes.y_low);
  if (axes.y_high > 0) axes.y_high += margin;
  if (axes.y_low < 0) axes.y_low -= margin;
  return axes;
}

// Calls draw(value) at each tick from low to high, about `count` of them.
template <class Draw>
void ForEachTick(double low, double high, int count, Draw draw) {
  const double step = NiceStep((high - low) / count);
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * (high - low); ++k) {
    draw(k == 0 ? 0.0 : k * step);
  }
}

std::string FormatPlotTicks(const Plot& plot, const PlotAxes& axes) {
  std::string svg;
  const auto out = std::back_inserter(svg);
  ForEachTick(axes.y_low, axes.y_high, 4, [&](double y) {
    fmt::format_to(out,
                   "<path class=\"grid\" d=\"M{} {:.1f}H{}\"/>"
                   "<text text-anchor=\"end\" x=\"{}\" y=\"{:.1f}\">{:g}</text>",
                   axes.left, axes.Y(y), axes.right, axes.left - 6, axes.Y(y) + 4, y);
  });
  ForEachTick(axes.x_low, axes.x_high, 5, [&](double x) {
    fmt::format_to(out,
                   "<path class=\"axis\" d=\"M{0:.1f} {1}v4\"/>"
                   "<text text-anchor=\"middle\" x=\"{0:.1f}\" y=\"{2}\">{3:g}</text>",
                   axes.X(x), axes.bottom, axes.bottom + 18, x);
  });
  fmt::format_to(out,
                 "<path class=\"axis\" d=\"M{} {}V{}H{}\"/>"
                 "<text x=\"4\" y=\"15\">{}</text>"
                 "<text text-anchor=\"end\" x=\"{}\" y=\"{}\">{}</text>",
                 axes.left, axes.top, axes.bottom, axes.right, plot.y_label, axes.right,
                 plot.height - 6, plot.x_label);
  return svg;
}

std::string FormatPlotCurve(const Plot::Curve& curve, const PlotAxes& axes) {
  std::string path, bars;
  bool pen_down = false;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    const bool seen = std::isfinite(curve.y[i]);
    if (seen) {
      const double x = axes.X(curve.x[i]);
      fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}", pen_down ? "L" : "M", x,
                     axes.Y(curve.y[i]));
      if (!curve.error.empty()) {
        fmt::format_to(std::back_inserter(bars), "M{:.1f} {:.1f}V{:.1f}", x,
                       axes.Y(curve.y[i] - curve.error[i]), axes.Y(curve.y[i] + curve.error[i]));
      }
    }
    pen_down = seen;
  }
  std::string svg = fmt::format("<path class=\"curve {}\" d=\"{}\"/>", curve.css_class, path);
  if (!bars.empty()) {
    svg += fmt::format("<path class=\"whisker {}\" d=\"{}\"/>", curve.css_class, bars);
  }
  return svg;
}

}  // namespace

std::string FormatPlot(const Plot& plot) {
  const PlotAxes axes = FitPlotAxes(plot);
  if (axes.IsEmpty()) return "";
  std::string svg = fmt::format(
      "<svg class=\"plot\" viewBox=\"0 0 {} {}\" data-left=\"{}\" data-right=\"{}\" role=\"img\" "
      "aria-label=\"{}\">",
      plot.width, plot.height, axes.left, axes.right, plot.title);
  for (const Plot::Range& range : plot.shaded) {
    const double from = axes.X(std::max(range.from, axes.x_low));
    const double to = axes.X(std::min(range.to, axes.x_high));
    svg +=
        fmt::format("<rect class=\"shaded\" x=\"{:.1f}\" y=\"{}\" width=\"{:.1f}\" height=\"{}\"/>",
                    from, axes.top, std::max(0.0, to - from), axes.bottom - axes.top);
  }
  svg += FormatPlotTicks(plot, axes);
  if (axes.y_low < 0) {
    svg +=
        fmt::format("<path class=\"axis\" d=\"M{} {:.1f}H{}\"/>", axes.left, axes.Y(0), axes.right);
  }
  for (const Plot::Line& line : plot.lines) {
    svg += fmt::format("<path class=\"line {}\" d=\"M{} {:.1f}H{}\"/>", line.css_class, axes.left,
                       axes.Y(line.y), axes.right);
  }
  for (const Plot::Curve& curve : plot.curves) svg += FormatPlotCurve(curve, axes);
  if (plot.cursor) {
    svg += fmt::format("<line class=\"cursor\" x1=\"{0}\" x2=\"{0}\" y1=\"{1}\" y2=\"{2}\"/>",
                       axes.left, axes.top, axes.bottom);
  }
  return svg + "</svg>\n";
}

Plot::Curve SeriesCurve(const std::vector<double>& y, double step, double offset, double factor,
                        const std::string& css_class) {
  Plot::Curve curve;
  curve.css_class = css_class;
  for (std::size_t i = 0; i < y.size(); ++i) {
    curve.x.push_back((static_cast<double>(i) + offset) * step);
    curve.y.push_back(factor * y[i]);
  }
  return curve;
}

}  // namespace physpring

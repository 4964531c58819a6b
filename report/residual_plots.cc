// SPDX-License-Identifier: Apache-2.0
#include "report/residual_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "report/picture/view.h"

namespace physpring {
namespace {

constexpr const char* kAxisColours[] = {"#c33", "#393", "#25c"};
constexpr double kPlotWidth = 400, kPlotHeight = 240, kPlotLeft = 60, kPlotRight = 390,
                 kPlotTop = 26, kPlotBottom = 205;

struct ForceCurve {
  std::vector<double> x, y;
  const char* colour;
};

// A plot with its title above, what runs along x below it, and forces in mN along y; a dashed line
// at `noise` [N], if it is not 0.
std::string ForcePlot(const std::string& title, const std::string& along,
                      std::vector<ForceCurve> curves, double noise) {
  double left = 0, right = 0, low = 0, high = 1e3 * noise;
  for (ForceCurve& curve : curves) {
    for (double& y : curve.y) y *= 1e3;
    for (double x : curve.x) left = std::min(left, x), right = std::max(right, x);
    for (double y : curve.y) low = std::min(low, y), high = std::max(high, y);
  }
  if (right <= left || high <= low) return "";
  const auto at_x = [&](double x) {
    return kPlotLeft + (kPlotRight - kPlotLeft) * (x - left) / (right - left);
  };
  const auto at_y = [&](double y) {
    return kPlotBottom - (kPlotBottom - kPlotTop) * (y - low) / (high - low);
  };
  std::string svg = fmt::format(
      "<svg viewBox='0 0 {0} {1}' role='img' aria-label='{2}'><text x='{3}' y='16'>{2}</text>"
      "<text x='{4}' y='{5}' text-anchor='end'>{6}</text>",
      kPlotWidth, kPlotHeight, title, kPlotLeft, kPlotRight, kPlotHeight - 4, along);
  const auto line = [&](double y, const char* style) {
    svg += fmt::format("<line x1='{}' x2='{}' y1='{:.1f}' y2='{:.1f}' stroke='#888' {}/>",
                       kPlotLeft, kPlotRight, at_y(y), at_y(y), style);
  };
  line(0, "");
  if (noise > 0) line(1e3 * noise, "stroke-dasharray='4'");
  for (double y : {low, high}) {
    svg += fmt::format("<text x='{}' y='{:.1f}' text-anchor='end'>{:.3g}{}</text>", kPlotLeft - 5,
                       at_y(y) + 4, y, y == high ? " mN" : "");
  }
  for (double x : {left, right}) {
    svg += fmt::format("<text x='{:.1f}' y='{}' text-anchor='{}'>{:.3g}</text>", at_x(x),
                       kPlotBottom + 16, x == left ? "start" : "end", x);
  }
  for (const ForceCurve& curve : curves) {
    std::string points;
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      points += fmt::format("{:.1f},{:.1f} ", at_x(curve.x[i]), at_y(curve.y[i]));
    }
    svg += fmt::format("<polyline fill='none' stroke='{}' stroke-width='1.5' points='{}'/>",
                       curve.colour, points);
  }
  return svg + "</svg>";
}

// A series as a curve; entry i is at (i + offset) * step.
ForceCurve Series(const std::vector<double>& y, double step, double offset, const char* colour) {
  ForceCurve curve{{}, y, colour};
  for (std::size_t i = 0; i < y.size(); ++i) {
    curve.x.push_back((static_cast<double>(i) + offset) * step);
  }
  return curve;
}

// Nodes in the reference configuration, and the mean force on each.
std::string ForceArrows(const Diagnosis& diagnosis, const View& view) {
  const ResidualPattern &before = diagnosis.residual_before, &after = diagnosis.residual_after;
  const Eigen::Matrix2Xd nodes = view.Project(view.ToUpright(before.node));
  if (nodes.cols() < 2) return "";
  const Eigen::Vector2d low = nodes.rowwise().minCoeff(), high = nodes.rowwise().maxCoeff();
  const double size = (high - low).maxCoeff();
  const double largest = std::max(before.mean_force.colwise().norm().maxCoeff(),
                                  after.mean_force.colwise().norm().maxCoeff());
  if (size <= 0 || largest <= 0) return "";
  const double margin = 0.25 * size, scale = 0.2 * size / largest;  // m per N
  std::string svg = fmt::format(
      "<svg viewBox='{} {} {} {}' role='img' aria-label='Mean missing force on each node'>",
      1e3 * (low[0] - margin), -1e3 * (high[1] + margin), 1e3 * (high[0] - low[0] + 2 * margin),
      1e3 * (high[1] - low[1] + 2 * margin));
  const double radius = 4 * size;  // in units of the picture, mm
  const auto add = [&](const ResidualPattern& pattern, const char* colour) {
    // a force is a difference of two points
    const Eigen::Matrix2Xd ends =
        view.Project(view.ToUpright(pattern.node + scale * pattern.mean_force));
    for (Eigen::Index i = 0; i < nodes.cols(); ++i) {
      svg += fmt::format(
          "<circle cx='{0:.2f}' cy='{1:.2f}' r='{2:.2f}' fill='#999'/><line x1='{0:.2f}' "
          "y1='{1:.2f}' x2='{3:.2f}' y2='{4:.2f}' stroke='{5}' stroke-width='{6:.2f}'/>",
          1e3 * nodes(0, i), -1e3 * nodes(1, i), radius, 1e3 * ends(0, i), -1e3 * ends(1, i),
          colour, 0.8 * radius);
    }
  };
  add(before, kBeforeColour);
  if (!diagnosis.effects.empty()) add(after, kAfterColour);
  return svg + fmt::format("</svg><p>Mean force on each node; the longest is {:.3g} mN.</p>",
                           1e3 * largest);
}

}  // namespace

std::string FormatResidualPlots(const Diagnosis& diagnosis, const Recording& recording) {
  const ResidualPattern &before = diagnosis.residual_before, &after = diagnosis.residual_after;
  const bool both = !diagnosis.effects.empty();
  const auto curves = [&](auto curve_of) {
    std::vector<ForceCurve> of_both{curve_of(before, kBeforeColour)};
    if (both) of_both.push_back(curve_of(after, kAfterColour));
    return of_both;
  };
  const auto binned = [&](BinnedMeans ResidualPattern::*means) {
    return curves([&](const ResidualPattern& pattern, const char* colour) {
      return ForceCurve{(pattern.*means).x, (pattern.*means).y, colour};
    });
  };
  const double noise = before.noise;
  std::string page = ForceArrows(diagnosis, View(recording)) + "<div class='plots'>";
  page += ForcePlot("along the body", "from one end to the other",
                    binned(&ResidualPattern::along_body), noise);
  page +=
      ForcePlot("over time", "s", curves([&](const ResidualPattern& pattern, const char* colour) {
                  return Series(pattern.over_time, 1 / recording.fps, 0.5, colour);
                }),
                noise);
  std::vector<ForceCurve> axes;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::VectorXd component = after.net.row(axis);
    axes.push_back(
        Series({component.begin(), component.end()}, 1 / recording.fps, 0.5, kAxisColours[axis]));
  }
  page += ForcePlot("still missing, of all nodes together: x red, y green, z blue", "s", axes, 0);
  page += ForcePlot("of all nodes together, by frequency", "Hz",
                    curves([&](const ResidualPattern& pattern, const char* colour) {
                      return Series(pattern.spectrum, pattern.frequency_step, 1, colour);
                    }),
                    0);
  page += ForcePlot("along the velocity, against the speed", "m/s",
                    binned(&ResidualPattern::against_speed), 0);
  page += ForcePlot("towards stretched springs, against the stretch", "sum of strains",
                    binned(&ResidualPattern::against_stretch), 0);
  return page + "</div>";
}

}  // namespace physpring

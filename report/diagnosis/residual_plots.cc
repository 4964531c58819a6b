// SPDX-License-Identifier: Apache-2.0
#include "report/diagnosis/residual_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "report/picture/body_panel.h"
#include "report/picture/plot.h"
#include "report/picture/quantity.h"

namespace physpring {
namespace {

constexpr double kLongestForce = 60;  // px
constexpr double kMillinewton = 1e3;  // in a newton
constexpr const char* kForce = "force on a node, mN";

std::string InFigure(const std::string& svg, const std::string& caption) {
  if (svg.empty()) return "";
  return fmt::format("<figure><figcaption>{}</figcaption>{}</figure>\n", Capitalised(caption), svg);
}

Plot::Curve BinnedCurve(const BinnedMeans& means, const char* css_class) {
  Plot::Curve curve{means.x, means.y, css_class, means.error};
  for (double& y : curve.y) y *= kMillinewton;
  for (double& error : curve.error) error *= kMillinewton;
  return curve;
}

// Curves of the forces without the effects, and with them where there are any.
class ForcePlots {
 public:
  ForcePlots(const Diagnosis& diagnosis, double fps) : diagnosis_(diagnosis), fps_(fps) {}

  std::string Binned(const std::string& caption, const std::string& along, const char* force,
                     BinnedMeans ResidualPattern::*means, double noise) const {
    Plot plot{caption, along, force, {}, {}, {}};
    plot.curves.push_back(BinnedCurve(diagnosis_.residual_before.*means, "before"));
    if (both()) plot.curves.push_back(BinnedCurve(diagnosis_.residual_after.*means, "after"));
    if (noise > 0) plot.lines.push_back({kMillinewton * noise, "noise"});
    return InFigure(FormatPlot(plot), caption);
  }

  std::string OverTime() const {
    Plot plot{"over time", "time, s", kForce, {}, {}, {}};
    plot.curves.push_back(InTime(diagnosis_.residual_before.over_time, "before"));
    if (both()) plot.curves.push_back(InTime(diagnosis_.residual_after.over_time, "after"));
    plot.lines.push_back({kMillinewton * diagnosis_.residual_before.noise, "noise"});
    return InFigure(FormatPlot(plot), "over time");
  }

  std::string Net() const {
    Plot plot{"still missing, of all nodes together", "time, s", "sum of forces, mN", {}, {}, {}};
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::VectorXd component = diagnosis_.residual_after.net.row(axis);
      plot.curves.push_back(
          InTime({component.begin(), component.end()}, fmt::format("axis{}", axis)));
    }
    return InFigure(FormatPlot(plot),
                    std::string("still missing, of all nodes together: ") + kAxesLegend);
  }

  std::string Spectrum() const {
    Plot plot{"of all nodes together, by frequency", "frequency, Hz", "amplitude, mN", {}, {}, {}};
    const auto add = [&](const ResidualPattern& pattern, const char* css_class) {
      plot.curves.push_back(
          SeriesCurve(pattern.spectrum, pattern.frequency_step, 1, kMillinewton, css_class));
    };
    add(diagnosis_.residual_before, "before");
    if (both()) add(diagnosis_.residual_after, "after");
    return InFigure(FormatPlot(plot), plot.title);
  }

 private:
  bool both() const { return !diagnosis_.effects.empty(); }
  Plot::Curve InTime(const std::vector<double>& forces, const std::string& css_class) const {
    return SeriesCurve(forces, 1 / fps_, 0.5, kMillinewton, css_class);
  }

  const Diagnosis& diagnosis_;
  double fps_;
};

// Nodes in the reference configuration, and the mean force on each.
std::string ForceArrows(const Diagnosis& diagnosis, const View& view) {
  const ResidualPattern &before = diagnosis.residual_before, &after = diagnosis.residual_after;
  if (before.node.cols() < 2) return "";
  const double largest = std::max(before.mean_force.colwise().norm().maxCoeff(),
                                  after.mean_force.colwise().norm().maxCoeff());
  if (largest <= 0) return "";
  const BodyPanel panel(view, before.node, 480);
  std::string dots, svg;
  for (Eigen::Index i = 0; i < before.node.cols(); ++i) {
    const Eigen::Vector2d at = panel.Pixel(before.node.col(i));
    dots += fmt::format("M{:.1f} {:.1f}h0", at.x(), at.y());
  }
  const auto add = [&](const ResidualPattern& pattern, const std::string& css_class) {
    for (Eigen::Index i = 0; i < pattern.node.cols(); ++i) {
      const Eigen::Vector2d from = panel.Pixel(pattern.node.col(i));
      const Eigen::Vector2d force = panel.Across(pattern.mean_force.col(i));
      svg += panel.Arrow(from, from + kLongestForce / largest * force, "force " + css_class);
    }
  };
  add(before, "before");
  if (!diagnosis.effects.empty()) add(after, "after");
  return InFigure(panel.Wrap("<path class=\"node\" d=\"" + dots + "\"/>" + svg + panel.ScaleBar() +
                                 panel.Axes(),
                             "Mean missing force on each node"),
                  "Mean force on each node; the longest is " + FormatQuantity(largest, "N") + ".");
}

}  // namespace

std::string FormatResidualPlots(const Diagnosis& diagnosis, double fps, const View& view) {
  if (!diagnosis.residual_before.converged || !diagnosis.residual_after.converged) {
    return "<p>The search for the missing forces did not converge, so none are shown.</p>\n";
  }
  const ForcePlots plots(diagnosis, fps);
  const double noise = diagnosis.residual_before.noise;
  return "<div class=\"plots\">\n" + ForceArrows(diagnosis, view) +
         plots.Binned("along the body", "from one end (0) to the other (1)", kForce,
                      &ResidualPattern::along_body, noise) +
         plots.OverTime() + plots.Net() + plots.Spectrum() +
         plots.Binned("along the velocity, against the speed", "speed, m/s",
                      "force along the velocity, mN", &ResidualPattern::against_speed, 0) +
         plots.Binned("towards stretched springs, against the stretch",
                      "sum of the springs' strains", "force towards them, mN",
                      &ResidualPattern::against_stretch, 0) +
         "</div>\n";
}

}  // namespace physpring

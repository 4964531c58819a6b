// SPDX-License-Identifier: Apache-2.0
// A plot with axes, ticks and units (SVG): curves, lines at a height, shaded ranges of x.
#ifndef PHYSPRING_REPORT_PICTURE_PLOT_H_
#define PHYSPRING_REPORT_PICTURE_PLOT_H_

#include <string>
#include <vector>

namespace physpring {

struct Plot {
  struct Curve {
    std::vector<double> x, y;   // NaN breaks the line
    std::string css_class;      // colour
    std::vector<double> error;  // half an error bar at each point; empty: none
  };
  struct Line {
    double y;
    std::string css_class;
  };
  struct Range {
    double from, to;  // along x
  };

  std::string title;             // for those who do not see it
  std::string x_label, y_label;  // with units
  std::vector<Curve> curves;
  std::vector<Line> lines;
  std::vector<Range> shaded;
  double width = 400, height = 230;  // px
  // Whether a cursor follows the film (film.js): then x runs from its first frame to its last one.
  bool cursor = false;
};

// Of x, y and z where they are drawn as curves of the classes axis0 to axis2: HTML.
inline constexpr char kAxesLegend[] =
    "<i class=\"key axis0\"></i>x <i class=\"key axis1\"></i>y <i class=\"key axis2\"></i>z";

// A <svg class="plot">; empty if there is nothing to draw. 0 is always on the y axis.
std::string FormatPlot(const Plot& plot);

// A series as a curve: entry i is at (i + offset) * step, and times `factor`.
Plot::Curve SeriesCurve(const std::vector<double>& y, double step, double offset, double factor,
                        const std::string& css_class);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_PICTURE_PLOT_H_

// SPDX-License-Identifier: Apache-2.0
#include "report/diagnosis/effect_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/diagnosis/effect_words.h"
#include "report/picture/body_panel.h"
#include "report/picture/plot.h"
#include "report/picture/quantity.h"
#include "twin/effects/body_coordinate.h"

namespace physpring {
namespace {

constexpr double kFigureWidth = 480;  // px
constexpr double kArrow = 70;         // px, the longest arrow

// Where a thing at the place is attached: the mean of the nodes that carry it.
Eigen::Vector3d Attached(const SpringMassSystem& system, const Eigen::Vector3d& place) {
  return system.position.leftCols(system.node_count()) * PatchWeights(system, place);
}

// The body and what holds it. An anchor far away is shown in its direction.
struct Scene {
  Points shown;
  std::vector<Eigen::Vector3d> attached;                // of each place
  std::vector<std::optional<Eigen::Vector3d>> anchors;  // as drawn
};

Scene LayOut(const SpringMassSystem& system, const EffectPicture& picture) {
  Scene scene{system.position, {}, {}};
  const double size =
      (system.position.rowwise().maxCoeff() - system.position.rowwise().minCoeff()).norm();
  for (const EffectPicture::Place& place : picture.places) {
    scene.attached.push_back(Attached(system, place.place));
    scene.anchors.push_back(place.anchor);
    if (!place.anchor) continue;
    const Eigen::Vector3d rope = *place.anchor - scene.attached.back();
    if (rope.norm() > size) scene.anchors.back() = scene.attached.back() + size * rope.normalized();
    scene.shown.conservativeResize(3, scene.shown.cols() + 1);
    scene.shown.rightCols(1) = *scene.anchors.back();
  }
  return scene;
}

std::string DrawPlaces(const Scene& scene, const BodyPanel& panel) {
  std::string svg;
  for (std::size_t i = 0; i < scene.attached.size(); ++i) {
    const Eigen::Vector2d at = panel.Pixel(scene.attached[i]);
    if (scene.anchors[i]) {
      const Eigen::Vector2d to = panel.Pixel(*scene.anchors[i]);
      svg += fmt::format(
          "<path class=\"effect\" d=\"M{0:.1f} {1:.1f}L{2:.1f} {3:.1f}m-6 -6l12 12m-12 0l12 "
          "-12\"/><text class=\"effect\" x=\"{4:.1f}\" y=\"{5:.1f}\">anchor</text>",
          at.x(), at.y(), to.x(), to.y(), to.x() + 10, to.y() - 8);
    }
    svg += fmt::format("<circle class=\"effect\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"9\"/>", at.x(),
                       at.y());
    svg += fmt::format("<circle class=\"effect dot\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\"/>", at.x(),
                       at.y());
  }
  return svg;
}

// From the middle of the body.
std::string DrawArrows(const EffectPicture& picture, const SpringMassSystem& system,
                       const BodyPanel& panel) {
  double longest = 0;
  for (const EffectPicture::Arrow& arrow : picture.arrows) {
    longest = std::max(longest, arrow.vector.norm());
  }
  const Eigen::Vector2d from = panel.Pixel(system.position.rowwise().mean());
  std::string svg;
  for (const EffectPicture::Arrow& arrow : picture.arrows) {
    if (longest == 0) continue;
    svg += panel.Arrow(from, from + kArrow / longest * panel.Across(arrow.vector),
                       arrow.declared ? "declared" : "effect");
  }
  return svg;
}

// The ends of the body's coordinate, as the profiles count it.
std::string DrawEnds(const SpringMassSystem& system, const BodyPanel& panel) {
  const Eigen::VectorXd along = BodyCoordinate(system);
  Eigen::Index low = 0, high = 0;
  along.minCoeff(&low);
  along.maxCoeff(&high);
  std::string svg;
  for (const auto& [node, name] : {std::pair{low, "0"}, std::pair{high, "1"}}) {
    const Eigen::Vector2d at = panel.Pixel(system.position.col(node));
    svg += fmt::format(
        "<text class=\"end\" text-anchor=\"middle\" x=\"{:.1f}\" y=\"{:.1f}\">{}"
        "</text>",
        at.x(), at.y() - 14, name);
  }
  return svg;
}

std::string DescribeVector(const Eigen::Vector3d& v) {
  return fmt::format("({:.3g}, {:.3g}, {:.3g})", v[0], v[1], v[2]);
}

std::string CaptionOf(const EffectPicture& picture) {
  std::string caption = "The body as it is declared, without stress. Squares: what is held.";
  for (const EffectPicture::Place& place : picture.places) {
    caption += fmt::format(" Ring: where it acts, at {} m.", DescribeVector(place.place));
    if (place.anchor) {
      caption += fmt::format(" Cross: the anchor, at {} m.", DescribeVector(*place.anchor));
    }
  }
  for (const EffectPicture::Arrow& arrow : picture.arrows) {
    caption += fmt::format(" {} arrow: {}, {} {}.", arrow.declared ? "Grey" : "Bold", arrow.label,
                           DescribeVector(arrow.vector), ScaleFor(arrow.unit, 1).unit);
  }
  return caption;
}

// The values of a profile or of one component of a course, with their error bars.
Plot::Curve RangeCurve(const std::vector<ValueRange>& ranges, int first, int count, double step,
                       const Scale& scale) {
  Plot::Curve curve;
  for (int k = 0; k < count; ++k) {
    const ValueRange& range =
        ranges.at(static_cast<std::size_t>(first) + static_cast<std::size_t>(k));
    curve.x.push_back(k * step);
    curve.y.push_back(scale.factor * range.value);
    curve.error.push_back(scale.factor * (range.high - range.low) / 2);
  }
  return curve;
}

Scale ScaleOfRanges(const std::vector<ValueRange>& ranges, int first, int count) {
  double largest = 0;
  for (int i = first; i < first + count; ++i) {
    largest = std::max(largest, std::abs(ranges[static_cast<std::size_t>(i)].value));
  }
  return ScaleFor(ranges[static_cast<std::size_t>(first)].unit, largest);
}

std::string WithUnit(const std::string& label, const Scale& scale) {
  return scale.unit.empty() ? label : label + ", " + scale.unit;
}

std::string DrawProfile(const EffectPicture::Profile& profile,
                        const std::vector<ValueRange>& ranges) {
  const Scale scale = ScaleOfRanges(ranges, profile.first, profile.count);
  Plot plot{profile.label,
            "along the body, from end 0 to end 1",
            WithUnit(profile.label, scale),
            {RangeCurve(ranges, profile.first, profile.count, 1.0 / (profile.count - 1), scale)},
            {},
            {}};
  plot.curves[0].css_class = "after";
  return fmt::format(
      "<figure>{}<figcaption>{} along the body, with 95 % intervals.</figcaption>"
      "</figure>\n",
      FormatPlot(plot), Capitalised(profile.label));
}

std::string DrawCourse(const EffectPicture::Course& course, const std::vector<ValueRange>& ranges) {
  const Scale scale = ScaleOfRanges(ranges, course.first, 3 * course.count);
  Plot plot{course.label, "time, s", WithUnit(course.label, scale), {}, {}, {}};
  for (int axis = 0; axis < 3; ++axis) {
    plot.curves.push_back(RangeCurve(ranges, course.first + axis * course.count, course.count,
                                     course.interval, scale));
    plot.curves.back().css_class = fmt::format("axis{}", axis);
  }
  return fmt::format(
      "<figure>{}<figcaption>{} in time, with 95 % intervals: {}.</figcaption>"
      "</figure>\n",
      FormatPlot(plot), Capitalised(course.label), kAxesLegend);
}

}  // namespace

std::string FormatEffectFigures(const Diagnosis& diagnosis, std::size_t effect, const View& view) {
  const SpringMassSystem& system = diagnosis.twin.levels[0].system;
  const EffectPicture picture = PictureOf(diagnosis, diagnosis.effects[effect]);
  const std::vector<ValueRange> ranges = RangesOf(diagnosis, effect);
  std::string html;
  if (!picture.places.empty() || !picture.arrows.empty() || !picture.profiles.empty()) {
    const Scene scene = LayOut(system, picture);
    const BodyPanel panel(view, scene.shown, kFigureWidth);
    std::string svg = panel.Springs(system) + panel.Controllers(system) + panel.ScaleBar() +
                      panel.Axes() + DrawPlaces(scene, panel) + DrawArrows(picture, system, panel);
    if (!picture.profiles.empty()) svg += DrawEnds(system, panel);
    html += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n",
                        panel.Wrap(svg, "Where it acts on the body"), CaptionOf(picture));
  }
  for (const EffectPicture::Profile& profile : picture.profiles)
    html += DrawProfile(profile, ranges);
  for (const EffectPicture::Course& course : picture.courses) html += DrawCourse(course, ranges);
  if (html.empty()) return "<p>It acts " + picture.where + ", in no direction of its own.</p>\n";
  return "<div class=\"plots\">\n" + html + "</div>\n";
}

}  // namespace physpring

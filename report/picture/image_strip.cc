// SPDX-License-Identifier: Apache-2.0
#include "report/picture/image_strip.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "pictures/png_file.h"
#include "report/picture/base64.h"
#include "report/picture/escape.h"

namespace physpring {
namespace {

// The part of all pictures in which something is, with a margin.
PixelBox CommonPart(const std::vector<ShownPicture>& shown) {
  constexpr int kMargin = 8;  // pixels
  const Image& first = shown[0].recorded;
  PixelBox part{first.width, first.height, 0, 0};
  for (const ShownPicture& picture : shown) {
    const PixelBox box = BoxNotBlack(picture.recorded, picture.predicted);
    if (box.empty()) continue;
    part = {std::min(part.left, box.left), std::min(part.top, box.top),
            std::max(part.right, box.right), std::max(part.bottom, box.bottom)};
  }
  if (part.empty()) return {0, 0, first.width, first.height};
  return {std::max(0, part.left - kMargin), std::max(0, part.top - kMargin),
          std::min(first.width, part.right + kMargin),
          std::min(first.height, part.bottom + kMargin)};
}

Image Cut(const Image& image, const PixelBox& part) {
  Image cut{part.right - part.left, part.bottom - part.top, {}};
  for (int y = part.top; y < part.bottom; ++y) {
    const auto row = image.rgb.begin() + 3 * (static_cast<std::ptrdiff_t>(y) * image.width);
    cut.rgb.insert(cut.rgb.end(), row + 3 * part.left, row + 3 * part.right);
  }
  return cut;
}

Image Difference(const Image& one, const Image& other) {
  Image difference{one.width, one.height, std::vector<unsigned char>(one.rgb.size())};
  std::transform(
      one.rgb.begin(), one.rgb.end(), other.rgb.begin(), difference.rgb.begin(),
      [](unsigned char a, unsigned char b) { return static_cast<unsigned char>(std::abs(a - b)); });
  return difference;
}

std::string Figure(const Image& image, const std::string& caption) {
  return fmt::format(
      "<figure><img alt=\"{0}\" src=\"data:image/png;base64,{1}\"><figcaption>{0}</figcaption>"
      "</figure>\n",
      caption, Base64(PngBytes(image)));
}

}  // namespace

std::string FormatImageStrip(const EvaluatedRecording& evaluated) {
  const ImageEvaluation& images = *evaluated.images;
  std::string html =
      fmt::format("<h3>Pictures</h3>\n<pre>{}</pre>\n", Escape(FormatImageTable(evaluated)));
  if (images.shown.empty()) return html;
  const PixelBox part = CommonPart(images.shown);
  const auto add_row = [&](const char* name, const auto& image_of) {
    html += "<div class=\"frames\">\n";
    for (const ShownPicture& shown : images.shown) {
      html += Figure(Cut(image_of(shown), part), fmt::format("{}, frame {}", name, shown.frame));
    }
    html += "</div>\n";
  };
  add_row("recorded", [](const ShownPicture& shown) { return shown.recorded; });
  add_row("level 0", [](const ShownPicture& shown) { return shown.predicted; });
  add_row("difference",
          [](const ShownPicture& shown) { return Difference(shown.recorded, shown.predicted); });
  return html;
}

}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
// The data of a page's film (film.js): motions over what was measured, positions in the upright
// frame of the view, as 16-bit numbers in base64.
#ifndef PHYSPRING_REPORT_PICTURE_FILM_DATA_H_
#define PHYSPRING_REPORT_PICTURE_FILM_DATA_H_

#include <optional>
#include <string>
#include <vector>

#include "report/picture/view.h"
#include "twin/spring_mass_system.h"

namespace physpring {

// A motion to show. It must outlive the film's data.
struct FilmLayer {
  const SpringMassSystem* system;
  const std::vector<Points>* nodes;   // T frames of 3 x nodes, m
  const std::vector<Points>* points;  // T frames: the measured points; null: the first nodes
};

// What frames from `first` on are called, and whether they were fitted.
struct FilmSpan {
  int first;
  std::string name;
  bool fitted;
};

// A place that a layer's node carries along, and what holds it there, if anything, m.
struct FilmMark {
  int layer, node;
  std::optional<Eigen::Vector3d> anchor;
};

struct FilmRecording {
  const Recording* recording;
  std::vector<FilmLayer> layers;
  std::vector<FilmSpan> spans;  // the first one begins at frame 0
  int begin;                    // the frame that is shown first
  std::vector<FilmMark> marks;
};

// JSON, safe inside a <script>; one view for each recording. If that would be too much for a page,
// only every second, third ... frame is in it.
std::string FormatFilmData(const std::vector<FilmRecording>& recordings,
                           const std::vector<View>& views);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_PICTURE_FILM_DATA_H_

// SPDX-License-Identifier: Apache-2.0
// The film of a page (HTML): screens to turn, and the controls below them. film.js moves it.
#ifndef PHYSPRING_REPORT_PICTURE_FILM_SECTION_H_
#define PHYSPRING_REPORT_PICTURE_FILM_SECTION_H_

#include <string>
#include <vector>

namespace physpring {

struct FilmSection {
  std::vector<std::string> recordings;  // names to choose from
  // Either one screen, and names of layers to choose from, or a screen for each layer, side by
  // side, with captions.
  std::vector<std::string> layers, captions;
};

std::string FormatFilmSection(const FilmSection& film);

// The scripts at the end of the page: the film's data (film_data.h) and what plays it.
std::string FormatFilmScripts(const std::string& data);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_PICTURE_FILM_SECTION_H_

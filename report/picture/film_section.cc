// SPDX-License-Identifier: Apache-2.0
#include "report/picture/film_section.h"

#include <fmt/format.h>

#include "report/picture/escape.h"

namespace physpring {

extern const char kFilmScript[];  // film.js, put into the program by the build

namespace {

std::string FormatScreens(const std::vector<std::string>& captions) {
  const char* const kLabel = "Film of the predicted motion over the measured points; drag to turn";
  if (captions.empty()) {
    return fmt::format("<canvas aria-label=\"{}\"></canvas>\n", kLabel);
  }
  std::string html = fmt::format("<div class=\"screens n{}\">\n", captions.size());
  for (std::size_t i = 0; i < captions.size(); ++i) {
    html += fmt::format(
        "<figure class=\"screen{0}\"><figcaption><i class=\"key springs\"></i>{1}</figcaption>"
        "<canvas data-layer=\"{0}\" aria-label=\"{2}\"></canvas></figure>\n",
        i, Escape(captions[i]), kLabel);
  }
  return html + "</div>\n";
}

std::string FormatSelect(const char* id, const char* label, const std::vector<std::string>& names) {
  std::string options;
  for (std::size_t i = 0; i < names.size(); ++i) {
    options += fmt::format("<option value=\"{}\">{}</option>", i, Escape(names[i]));
  }
  return fmt::format("<select id=\"{}\" aria-label=\"{}\">{}</select>", id, label, options);
}

}  // namespace

std::string FormatFilmSection(const FilmSection& film) {
  return "<section class=\"film\">" + FormatScreens(film.captions) +
         "<div class=\"controls\"><button id=\"play\" type=\"button\">Play</button>"
         "<div class=\"track\"><div id=\"fit-part\"></div>"
         "<input id=\"frame\" type=\"range\" min=\"0\" value=\"0\" aria-label=\"Frame\"></div>"
         "<output id=\"time\"></output></div>\n<div class=\"controls\">" +
         FormatSelect("recording", "Recording", film.recordings) +
         FormatSelect("level", "Level", film.layers) +
         "<select id=\"speed\" aria-label=\"Speed\"><option value=\"1\">real time</option>"
         "<option value=\"0.25\">1/4 speed</option><option value=\"0.0625\">1/16 speed</option>"
         "</select>"
         "<label><input id=\"show-springs\" type=\"checkbox\" checked>"
         "<i class=\"key springs\"></i>predicted</label>"
         "<label><input id=\"show-measured\" type=\"checkbox\" checked>"
         "<i class=\"key dots\"></i>measured</label>"
         "<label><input id=\"show-errors\" type=\"checkbox\" checked>"
         "<i class=\"key errors\"></i>difference</label>"
         "<span class=\"legend\"><i class=\"key held\"></i>controllers</span></div>\n"
         "</section>\n";
}

std::string FormatFilmScripts(const std::string& data) {
  return "<script type=\"application/json\" id=\"film-data\">" + data + "</script>\n<script>\n" +
         kFilmScript + "</script>\n";
}

}  // namespace physpring

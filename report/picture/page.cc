// SPDX-License-Identifier: Apache-2.0
#include "report/picture/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "report/picture/error_plot.h"
#include "report/picture/escape.h"
#include "report/picture/film_data.h"
#include "report/picture/film_section.h"
#include "report/picture/image_strip.h"
#include "report/picture/overlay.h"
#include "report/picture/view.h"

namespace physpring {

extern const char kPageStyle[];  // page.css, put into the program by the build

namespace {

constexpr std::size_t kMostDrawn = 20;

// About three digits.
std::string Millimetres(const std::optional<double>& metres) {
  if (!metres) return "–";
  const double millimetres = 1e3 * *metres;
  const int digits = millimetres < 9.995 ? 2 : millimetres < 99.95 ? 1 : 0;
  return fmt::format("{:.{}f}", millimetres, digits);
}

std::string FormatErrorCells(const RowErrors& errors, bool lifted) {
  std::string cells = fmt::format("<td class=\"first\">{}</td><td>{}</td>",
                                  Millimetres(errors.cd.value), Millimetres(errors.track.value));
  if (lifted) {
    cells += fmt::format("<td>{}</td><td>{}</td>", Millimetres(errors.cd_lifted.value),
                         Millimetres(errors.track_lifted.value));
  }
  return cells;
}

std::string FormatTableHead(bool fit, bool lifted, bool published) {
  const int columns = lifted ? 4 : 2;
  std::string parts = "<tr><th colspan=\"5\"></th>";
  std::string names = "<tr><th></th><th>nodes</th><th>springs</th><th>sub-steps</th><th>FPS</th>";
  const std::string errors =
      lifted ? "<th class=\"first\">CD</th><th>track</th><th>CD, lifted</th><th>track, lifted</th>"
             : "<th class=\"first\">CD</th><th>track</th>";
  if (fit) {
    parts +=
        fmt::format("<th class=\"part first\" colspan=\"{}\"><span>fit, mm</span></th>", columns);
    names += errors;
  }
  parts += fmt::format("<th class=\"part first\" colspan=\"{}\"><span>prediction, mm</span></th>",
                       columns);
  names += errors;
  if (published) {
    parts += "<th class=\"part first\"><span>cables, mm</span></th>";
    names += "<th class=\"first\">DEFORM L1</th>";
  }
  return "<thead>" + parts + "</tr>" + names + "</tr></thead>\n";
}

std::string FormatTable(const std::vector<Row>& rows) {
  const bool fit = rows[0].fit.has_value(), published = rows[0].published_l1.has_value();
  const bool lifted = rows.size() > 2;
  std::string html = "<table>\n" + FormatTableHead(fit, lifted, published) + "<tbody>\n";
  for (const Row& row : rows) {
    html += fmt::format("<tr><th>{}</th>", row.name);
    if (row.level >= 0) {
      html += fmt::format("<td>{}</td><td>{}</td><td>{}</td><td>{:.0f}</td>", row.nodes,
                          row.springs, row.substeps, row.frames_per_second);
    } else {
      html += "<td colspan=\"4\"></td>";
    }
    if (fit) html += FormatErrorCells(*row.fit, lifted);
    html += FormatErrorCells(row.prediction, lifted);
    if (published) {
      html += fmt::format("<td class=\"first\">{}</td>", Millimetres(row.published_l1));
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table>\n";
}

// "on a, b and c", or on how many recordings.
std::string FormatSubject(const Evaluation& evaluation) {
  std::vector<std::string> names;
  for (const EvaluatedRecording& evaluated : evaluation.recordings) {
    names.push_back(Escape(evaluated.recording.name));
  }
  if (names.size() > 3) return fmt::format("on {} recordings", names.size());
  const std::string last = names.back();
  names.pop_back();
  return names.empty() ? "on " + last : fmt::format("on {} and {}", fmt::join(names, ", "), last);
}

// What the page says in one line: level 0's track error where there is a prediction, else its fit.
std::string FormatLead(const Evaluation& evaluation) {
  const std::vector<Row> rows = MeanRows(evaluation);
  const bool predicts = rows[0].prediction.track.value.has_value() || !rows[0].fit;
  const auto track = [&](const Row& row) {
    return Millimetres(predicts ? row.prediction.track.value : row.fit->track.value);
  };
  return fmt::format(
      "<p class=\"lead\">{} at level 0 (<b>{}</b> nodes, <b>{}</b> springs): on average "
      "<b>{} mm</b> from the measured points. A body that does not move would be {} mm "
      "from them.</p>\n",
      predicts ? "Prediction" : "Fit", rows[0].nodes, rows[0].springs, track(rows[0]),
      track(rows[evaluation.twin.levels.size()]));  // the first baseline
}

FilmSection FilmOf(const Evaluation& evaluation, std::size_t drawn) {
  FilmSection film;
  for (std::size_t i = 0; i < drawn; ++i) {
    film.recordings.push_back(evaluation.recordings[i].recording.name);
  }
  for (std::size_t i = 0; i < evaluation.twin.levels.size(); ++i) {
    film.layers.push_back(fmt::format("level {}", i));
  }
  return film;
}

// The film begins where the prediction begins, else in the middle.
std::vector<FilmRecording> FilmRecordings(const Evaluation& evaluation, std::size_t drawn) {
  std::vector<FilmRecording> films;
  for (std::size_t i = 0; i < drawn; ++i) {
    const EvaluatedRecording& evaluated = evaluation.recordings[i];
    const int frames = evaluated.recording.frame_count(), split = evaluated.result.first_predicted;
    FilmRecording film{&evaluated.recording, {}, {}, frames / 2, {}};
    for (const LevelResult& level : evaluated.result.levels) {
      // at level 0 the points are the first nodes
      film.layers.push_back({&evaluation.twin.levels[level.level].system, &level.positions,
                             level.level > 0 ? &level.points : nullptr});
    }
    film.spans.push_back({0, "fit", split > 1});
    film.spans.push_back({split, "prediction", false});
    if (split > 1 && split < frames) film.begin = split;
    films.push_back(film);
  }
  return films;
}

std::string FormatRecording(const EvaluatedRecording& evaluated, std::size_t number,
                            const Twin& twin, const View& view, bool with_table) {
  const Recording& recording = evaluated.recording;
  const RecordingResult& result = evaluated.result;
  std::string html = fmt::format(
      "<section data-recording=\"{}\"><h2>{}</h2>\n<p class=\"note\">{} frames at {:g} fps, {}.",
      number, Escape(recording.name), recording.frame_count(), recording.fps,
      result.trained_on ? fmt::format("of which 0 to {} were fitted", result.first_predicted - 1)
                        : "none of them seen in training");
  if (number == 0) {
    html += " Blue: level 0 as predicted; orange: measured, joined to where it was predicted.";
  }
  html += "</p>\n" + FormatOverlay(evaluated, twin, view);
  html += "<h3>Track error over time</h3>\n" + FormatErrorPlot(evaluated);
  if (with_table) html += FormatTable(RowsOf(evaluated));
  if (evaluated.images) html += FormatImageStrip(evaluated);
  return html + "</section>\n";
}

std::string FormatNotes(const Evaluation& evaluation) {
  std::string html = fmt::format(
      "<footer><p><b>track</b>: mean distance between measured points and where they were "
      "predicted. <b>CD</b>: mean L1 distance from a measured point to the nearest predicted one. "
      "Both are means over frames, of points that were seen. <b>lifted</b>: of the dense "
      "particles that a coarse level carries along; otherwise of its own nodes. <b>FPS</b>: "
      "simulated frames a second, {} precision.</p>\n",
      evaluation.single_precision ? "single" : "double");
  if (evaluation.recordings.size() > kMostDrawn) {
    html += fmt::format("<p>The first {} of {} recordings are drawn.</p>\n", kMostDrawn,
                        evaluation.recordings.size());
  }
  return html + fmt::format("<p>physpring {}: eval {}</p></footer>\n", PHYSPRING_VERSION,
                            Escape(evaluation.twin_path));
}

}  // namespace

std::string FormatPage(const Evaluation& evaluation) {
  const std::size_t drawn = std::min(evaluation.recordings.size(), kMostDrawn);
  const bool several = evaluation.recordings.size() > 1;
  std::vector<View> views;
  for (std::size_t i = 0; i < drawn; ++i) views.emplace_back(evaluation.recordings[i].recording);

  const std::string title = Escape(evaluation.twin.name);
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width\">\n<title>{0}</title>\n"
      "<style>\n{1}</style>\n</head>\n<body>\n<main>\n<h1>{0} <small>{2}</small></h1>\n",
      title, kPageStyle, FormatSubject(evaluation));
  html += FormatLead(evaluation);
  html += FormatFilmSection(FilmOf(evaluation, drawn));
  html += fmt::format("<section><h2>{}</h2>\n", several ? "Mean over the recordings" : "Errors");
  html += FormatTable(MeanRows(evaluation)) + "</section>\n";
  for (std::size_t i = 0; i < drawn; ++i) {
    html += FormatRecording(evaluation.recordings[i], i, evaluation.twin, views[i], several);
  }
  html += FormatNotes(evaluation);
  return html + "</main>\n" +
         FormatFilmScripts(FormatFilmData(FilmRecordings(evaluation, drawn), views)) +
         "</body>\n</html>\n";
}

}  // namespace physpring

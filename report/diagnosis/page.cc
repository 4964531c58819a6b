// SPDX-License-Identifier: Apache-2.0
#include "report/diagnosis/page.h"

#include <fmt/format.h>

#include "report/diagnosis/answer.h"
#include "report/diagnosis/effect_figure.h"
#include "report/diagnosis/effect_words.h"
#include "report/diagnosis/mjcf_lines.h"
#include "report/diagnosis/motion.h"
#include "report/diagnosis/ranking_bars.h"
#include "report/diagnosis/residual_plots.h"
#include "report/diagnosis_text.h"
#include "report/picture/escape.h"
#include "report/picture/film_section.h"
#include "report/picture/quantity.h"

namespace physpring {

// page.css and diagnosis.css, put into the program by the build
extern const char kPageStyle[];
extern const char kDiagnosisStyle[];

namespace {

std::string FormatErrorTable(const Diagnosis& diagnosis) {
  std::string html =
      "<h2>Errors</h2>\n<div class=\"wide\"><table><thead><tr><th></th><th>fitted frames</th>"
      "<th>held-back frames</th></tr></thead><tbody>\n";
  const auto row = [&](const char* name, const std::string& fit, const std::string& held) {
    html += fmt::format("<tr><th>{}</th><td>{}</td><td>{}</td></tr>\n", name, fit, held);
  };
  row("before", InMillimetres(diagnosis.before.fit), InMillimetres(diagnosis.before.held));
  if (!diagnosis.effects.empty()) {
    row("after", InMillimetres(diagnosis.after.fit), InMillimetres(diagnosis.after.held));
  }
  row("a body that does not move", "", InMillimetres(diagnosis.motionless));
  row("noise alone", InMillimetres(diagnosis.noise_floor), InMillimetres(diagnosis.noise_floor));
  html += "</tbody></table></div>\n";
  if (diagnosis.effects.empty()) return html;
  html += fmt::format("<p class=\"note\">Before minus after on held-back frames: {}.",
                      DescribeGain(diagnosis.gain));
  if (diagnosis.all_frames) {
    html += fmt::format(
        " Film and errors are of a fit that had not seen the held-back frames. The twin that was "
        "written was then fitted to them, too; its error over all frames is {}.",
        InMillimetres(*diagnosis.all_frames));
  }
  return html + "</p>\n";
}

std::string FormatValues(const std::vector<ValueRange>& ranges) {
  std::string html =
      "<div class=\"wide\"><table><thead><tr><th></th><th>value</th><th>95 % interval</th></tr>"
      "</thead><tbody>\n";
  for (const ValueRange& range : ranges) {
    const std::string interval =
        range.certainty && range.certainty->IsUntold() ? "not told by the recordings"
        : !range.certainty                             ? "–"
                           : FormatInterval(range.low, range.high, range.unit);
    html += fmt::format("<tr><th>{}</th><td>{}{}</td><td>{}</td></tr>\n", range.label,
                        FormatQuantity(range.value, range.unit),
                        range.at_bound ? " (at the edge)" : "", interval);
  }
  return html + "</tbody></table></div>\n";
}

std::string FormatEffects(const Diagnosis& diagnosis, const View& view) {
  std::string html;
  for (std::size_t n = 0; n < diagnosis.effects.size(); ++n) {
    const EffectValues& effect = diagnosis.effects[n];
    html +=
        fmt::format("<h2>Found: {}</h2>\n<p>{}.</p>\n{}{}", SpacedName(effect.name),
                    Capitalised(DescribeEffect(diagnosis, n)),
                    FormatEffectFigures(diagnosis, n, view), FormatValues(RangesOf(diagnosis, n)));
    html += FormatMjcfLines(effect, diagnosis.twin);
  }
  if (!html.empty()) {
    html += fmt::format("<p class=\"note\">Intervals: 95 %, {}.</p>\n",
                        "from the misfit's curvature and how alike neighbouring residuals are");
  }
  return html;
}

std::string FormatForces(const Diagnosis& diagnosis, const Recording& first, const View& view) {
  std::string html = fmt::format(
      "<h2>Forces that are missing</h2>\n<p>The smallest forces on the body with which the twin "
      "would follow {}. A place, a moment or a direction in them hints at the cause.</p>\n"
      "<p class=\"note\">{}. A motion that is hard to follow is held tighter, and its forces then "
      "look smaller: compare before and after in shape rather than in size.</p>\n",
      Escape(first.name), Capitalised(DescribeResidual(diagnosis)));
  const std::string plots = FormatResidualPlots(diagnosis, first.fps, view);
  html += "<p class=\"note\"><i class=\"key before\"></i>before ";
  if (!diagnosis.effects.empty()) html += "<i class=\"key after\"></i>after ";
  return html + "<i class=\"key noise\"></i>what noise alone would make</p>\n" + plots;
}

}  // namespace

std::string FormatDiagnosisPage(const Diagnosis& diagnosis, const DiagnosisRecordings& recordings,
                                const std::string& title) {
  const Recording& first = recordings.fit[0];
  const View view(first);
  const std::vector<ShownMotion> motions = PredictMotions(diagnosis, recordings);
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width\">\n<title>{0}</title>\n"
      "<style>\n{1}{2}</style>\n</head>\n<body>\n<main>\n<h1>{0}</h1>\n"
      "<p class=\"answer\">{3}</p>\n",
      Escape(title), kPageStyle, kDiagnosisStyle, FormatAnswer(diagnosis));
  html += FormatDoubts(diagnosis);
  html += FormatMotionFilm(diagnosis, motions);
  html += FormatMotionErrors(diagnosis, motions) + FormatErrorTable(diagnosis);
  html += FormatEffects(diagnosis, view);
  for (std::size_t round = 0; round < diagnosis.rankings.size(); ++round) {
    html += FormatRanking(diagnosis, round);
  }
  html += FormatConfounding(diagnosis) + FormatForces(diagnosis, first, view);
  html += fmt::format("<footer><p>{}.</p><p>physpring {}: diagnose</p></footer>\n</main>\n",
                      Escape(Capitalised(DescribeRecordings(diagnosis))), PHYSPRING_VERSION);
  if (!motions.empty()) html += FormatFilmScripts(FormatMotionData(diagnosis, motions));
  return html + "</body>\n</html>\n";
}

}  // namespace physpring

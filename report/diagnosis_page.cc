// SPDX-License-Identifier: Apache-2.0
#include "report/diagnosis_page.h"

#include <fmt/format.h>

#include <algorithm>

#include "report/diagnosis_text.h"
#include "report/picture/escape.h"
#include "report/residual_plots.h"
#include "twin/effects/registry.h"

namespace physpring {
namespace {

// How a MuJoCo model carries the effect.
std::string InMuJoCo(const EffectValues& effect, const SpringMassSystem& system) {
  const EffectMjcf mjcf = GetEffect(effect.name).Mjcf(effect.values, system);
  const auto with_difference = [&](const std::string& text) {
    return mjcf.difference.empty() ? text : fmt::format("{} ({})", text, mjcf.difference);
  };
  switch (mjcf.carrier) {
    case EffectMjcf::Carrier::kSetting:
      return "in MuJoCo: in the exported masses, rest lengths, gravity or contacts";
    case EffectMjcf::Carrier::kTendon: {
      std::string attributes;
      for (const auto& [name, value] : mjcf.tendon.at(0)) {
        attributes += fmt::format(" {}=&quot;{}&quot;", name, value);
      }
      return with_difference(
          fmt::format("in MuJoCo: on each spring's tendon, the first:{}", attributes));
    }
    case EffectMjcf::Carrier::kAnchor:
      return with_difference(
          fmt::format("in MuJoCo: {} tendons to a site of the world", mjcf.anchors.size()));
    case EffectMjcf::Carrier::kPlugin:
      break;
  }
  return with_difference("in MuJoCo: by the plugin only");
}

// A curve of the errors in time as SVG.
std::string TrackCurve(const FrameTrack& track, double top, const char* colour) {
  if (track.size() < 2) return "";
  std::string points;
  for (std::size_t i = 0; i < track.size(); ++i) {
    points += fmt::format("{:.1f},{:.1f} ",
                          800.0 * static_cast<double>(i) / static_cast<double>(track.size() - 1),
                          200 - 190 * track[i] / top);
  }
  return fmt::format("<polyline fill='none' stroke='{}' stroke-width='1.5' points='{}'/>", colour,
                     points);
}

std::string TrackPlot(const Diagnosis& diagnosis) {
  double top = diagnosis.noise_floor;
  for (double error : diagnosis.before_track) top = std::max(top, error);
  for (double error : diagnosis.after_track) top = std::max(top, error);
  if (top <= 0) return "";
  const double floor = 200 - 190 * diagnosis.noise_floor / top;
  return fmt::format(
      "<svg viewBox='0 0 800 210' role='img'><line x1='0' x2='800' y1='{0:.1f}' y2='{0:.1f}' "
      "stroke='#888' stroke-dasharray='4'/>{1}{2}</svg><p>Track error of held-out frames, one "
      "after the other; the top is {3}. Red: before, blue: after, dashed: noise floor.</p>",
      floor, TrackCurve(diagnosis.before_track, top, kBeforeColour),
      TrackCurve(diagnosis.after_track, top, kAfterColour), InMillimetres(top));
}

std::string RankingTable(const EffectRanking& ranking) {
  std::string table =
      "<table><tr><th>effect</th><th>part of the misfit, linearised</th>"
      "<th>held out, refitted</th><th>gain</th></tr>";
  for (const EffectCandidate& candidate : ranking) {
    table += fmt::format("<tr><td>{}</td><td>{:.1f} %</td><td>{}</td><td>{}</td></tr>",
                         candidate.name, 100 * candidate.score,
                         candidate.refit ? InMillimetres(candidate.refit->held) : "",
                         candidate.refit ? DescribeGain(candidate.gain) : "");
  }
  return table + "</table>";
}

}  // namespace

std::string FormatDiagnosisPage(const Diagnosis& diagnosis, const Recording& recording,
                                const std::string& title) {
  std::string page = fmt::format(
      "<!DOCTYPE html><html lang='en'><meta charset='utf-8'><title>{0}</title><style>body{{font:"
      "16px sans-serif;max-width:60em;margin:2em auto;padding:0 1em}}td,th{{padding:.2em 1em .2em "
      "0;text-align:left}}svg{{width:100%;border:1px solid "
      "#ccc}}.plots{{display:grid;grid-template-columns:1fr 1fr;gap:"
      "1em}}.plots text{{font-size:12px}}</style><h1>{0}</h1><p>{1}.</p><p>{2}.</p>",
      Escape(title), Escape(DescribeVerdict(diagnosis)), Escape(DescribeRecordings(diagnosis)));
  page += fmt::format(
      "<table><tr><th>track error</th><th>fitted frames</th><th>held-out frames</th></tr>"
      "<tr><td>before</td><td>{}</td><td>{}</td></tr><tr><td>after</td><td>{}</td><td>{}</td></tr>"
      "{}<tr><td>noise floor</td><td colspan='2'>{}</td></tr>"
      "<tr><td>a body that does not move</td><td></td><td>{}</td></tr></table><p>{}.</p>",
      InMillimetres(diagnosis.before.fit), InMillimetres(diagnosis.before.held),
      InMillimetres(diagnosis.after.fit), InMillimetres(diagnosis.after.held),
      diagnosis.all_frames
          ? fmt::format("<tr><td>twin, fitted to all frames</td><td colspan='2'>{}</td></tr>",
                        InMillimetres(*diagnosis.all_frames))
          : "",
      InMillimetres(diagnosis.noise_floor), InMillimetres(diagnosis.motionless),
      DescribeGain(diagnosis.gain));
  page += TrackPlot(diagnosis);
  page += "<h2>Effects added</h2><ul>";
  for (std::size_t i = 0; i < diagnosis.effects.size(); ++i) {
    const EffectValues& effect = diagnosis.effects[i];
    page += fmt::format("<li><b>{}</b>: {}; {}</li>", effect.name, DescribeParameters(diagnosis, i),
                        InMuJoCo(effect, diagnosis.twin.levels[0].system));
  }
  page += diagnosis.effects.empty() ? "<li>none</li></ul>" : "</ul>";
  if (!diagnosis.effects.empty()) {
    const std::string confounded = DescribeConfounded(diagnosis);
    page += fmt::format("<p>{}{}.</p>", DescribeCertainty(diagnosis),
                        confounded.empty() ? "" : "; " + confounded);
  }
  page += fmt::format("<h2>Forces that are missing</h2><p>{}.</p>{}", DescribeResidual(diagnosis),
                      FormatResidualPlots(diagnosis, recording));
  for (std::size_t i = 0; i < diagnosis.rankings.size(); ++i) {
    if (diagnosis.rankings[i].empty()) continue;  // nothing was missing any more
    std::string beside;
    for (std::size_t n = 0; n < i; ++n) {
      beside += (n == 0 ? ", beside " : " and ") + diagnosis.effects.at(n).name;
    }
    page += fmt::format("<h2>Candidates{}</h2>{}", beside, RankingTable(diagnosis.rankings[i]));
  }
  return page + "</html>\n";
}

}  // namespace physpring

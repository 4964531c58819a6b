// SPDX-License-Identifier: Apache-2.0
#include "report/diagnosis/ranking_bars.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/diagnosis/effect_words.h"
#include "report/picture/nice_step.h"
#include "report/picture/quantity.h"

namespace physpring {
namespace {

// Errors in mm along the bars, from 0 to `end`, as parts of 100 %.
struct ErrorScale {
  double end;  // mm

  double Percent(double millimetres) const { return 100 * std::clamp(millimetres / end, 0.0, 1.0); }
};

bool IsDrawn(const EffectCandidate& candidate) {
  return candidate.refit && std::isfinite(candidate.refit->held);
}

// The error without the effect, mm: what its gain is counted from.
double WithoutIt(const EffectCandidate& candidate) { return 1e3 * candidate.without; }

double BaselineOf(const EffectRanking& ranking) {
  double baseline = 0;
  for (const EffectCandidate& candidate : ranking) {
    if (IsDrawn(candidate)) baseline = std::max(baseline, WithoutIt(candidate));
  }
  return baseline;
}

// Far beyond the error without an effect, bars are cut.
ErrorScale ScaleOf(const EffectRanking& ranking, double baseline, double noise) {
  double end = 1.05 * std::max(baseline, 1e3 * noise);
  for (const EffectCandidate& candidate : ranking) {
    if (IsDrawn(candidate)) end = std::max(end, 1e3 * candidate.refit->held);
  }
  return {1.05 * std::min(end, 1.5 * std::max(baseline, 1e3 * noise))};
}

std::string FormatBar(const Diagnosis& diagnosis, const EffectCandidate& candidate,
                      const ErrorScale& scale, double baseline, bool chosen) {
  const double error = 1e3 * candidate.refit->held, without = WithoutIt(candidate);
  const double low = scale.Percent(without - 1e3 * candidate.gain.high);
  const double high = scale.Percent(without - 1e3 * candidate.gain.low);
  return fmt::format(
      "<div class=\"bar{}\"><span class=\"name\"><b>{}</b> {}</span><span class=\"rail\">"
      "<i class=\"fill\" style=\"width:{:.2f}%\"></i>"
      "<i class=\"whisker\" style=\"left:{:.2f}%;width:{:.2f}%\"></i>"
      "<i class=\"mark noise\" style=\"left:{:.2f}%\"></i>"
      "<i class=\"mark\" style=\"left:{:.2f}%\"></i></span>"
      "<span class=\"value\">{}{} mm</span></div>\n",
      chosen ? " chosen" : "", SpacedName(candidate.name),
      PictureOf(diagnosis, candidate.values).lacks, scale.Percent(error), low, high - low,
      scale.Percent(1e3 * diagnosis.noise_floor), scale.Percent(baseline),
      error > scale.end ? "→ " : "", InMm(candidate.refit->held));
}

std::string FormatBarAxis(const ErrorScale& scale) {
  std::string ticks;
  const double step = NiceStep(scale.end / 5);
  for (int k = 0; k * step <= scale.end * (1 + 1e-9); ++k) {
    ticks += fmt::format("<i style=\"left:{:.2f}%\">{:g}</i>", scale.Percent(k * step), k * step);
  }
  return fmt::format(
      "<div class=\"bar axis\"><span class=\"name\"></span><span class=\"rail\">{}</span>"
      "<span class=\"value\">mm</span></div>\n",
      ticks);
}

// Those that a linearised fit gave too little.
std::string DescribeOthers(const EffectRanking& ranking) {
  std::string others;
  for (const EffectCandidate& candidate : ranking) {
    if (IsDrawn(candidate)) continue;
    others += fmt::format("{}{} ({:.1f} %)", others.empty() ? "" : ", ", SpacedName(candidate.name),
                          100 * candidate.score);
  }
  if (others.empty()) return "";
  return "<p class=\"note\">Traced, but not fitted, with the part of the squared misfit that they "
         "would take away at most: " +
         others + ".</p>\n";
}

}  // namespace

std::string FormatRanking(const Diagnosis& diagnosis, std::size_t round) {
  const EffectRanking& ranking = diagnosis.rankings.at(round);
  if (ranking.empty()) return "";
  std::string html =
      round == 0 ? "<h2>All explanations that were tried</h2>\n" : "<h3>One more besides ";
  for (std::size_t n = 0; n < round; ++n) {
    html += (n == 0 ? "" : " and ") + SpacedName(diagnosis.effects.at(n).name);
  }
  if (round > 0) html += "</h3>\n";
  const double baseline = BaselineOf(ranking);
  if (baseline > 0) {
    const ErrorScale scale = ScaleOf(ranking, baseline, diagnosis.noise_floor);
    html += "<div class=\"bars\">\n";
    for (const EffectCandidate& candidate : ranking) {
      if (!IsDrawn(candidate)) continue;
      const bool chosen =
          round < diagnosis.effects.size() && candidate.name == diagnosis.effects[round].name;
      html += FormatBar(diagnosis, candidate, scale, baseline, chosen);
    }
    html += FormatBarAxis(scale) + "</div>\n";
    if (round == 0) {
      html +=
          "<p class=\"note\">Error on held-back frames with each of them alone; the shorter, the "
          "better. Whiskers: 95 % interval. Solid line: the error without any, dotted line: "
          "noise, arrow: a bar that is cut. Only numbers that all springs share were fitted "
          "besides, so these errors may "
          "differ from those above.</p>\n";
    }
  }
  return html + DescribeOthers(ranking);
}

}  // namespace physpring

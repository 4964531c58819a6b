// SPDX-License-Identifier: Apache-2.0
#include "cli/diagnosis_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/residual_plots.h"
#include "twin/effects/effect_json.h"
#include "twin/effects/registry.h"

namespace physpring {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kSteady = 0.7;  // a direction that turns by a third of a circle has 0.83

// null where there is nothing to average over
Json Number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json Pair(const TrackPair& track) {
  return {{"fit", Number(track.fit)}, {"heldout", Number(track.held)}};
}

// Names and parameters, and how well each parameter is known: a number or, where it has several
// values, a list, as in the parameters themselves.
Json EffectList(const Diagnosis& diagnosis) {
  Json list = Json::parse(EffectsToJson(diagnosis.effects));
  std::size_t i = 0;
  for (std::size_t n = 0; n < diagnosis.effects.size(); ++n) {
    Json errors = Json::object(), shared = Json::object();
    for (const EffectParameter& parameter : GetEffect(diagnosis.effects[n].name).parameters()) {
      Json of_error = Json::array(), of_shared = Json::array();
      for (int k = 0; k < parameter.count && i < diagnosis.certainty.size(); ++k, ++i) {
        of_error.push_back(Number(diagnosis.certainty[i].error));
        of_shared.push_back(Number(diagnosis.certainty[i].shared));
      }
      errors[parameter.key] = parameter.count == 1 && !of_error.empty() ? of_error[0] : of_error;
      shared[parameter.key] = parameter.count == 1 && !of_shared.empty() ? of_shared[0] : of_shared;
    }
    list[n]["standard_errors"] = errors;
    list[n]["shared"] = shared;
  }
  return list;
}

// The effects that the held-out frames cannot tell from the first one accepted.
Json Confounded(const Diagnosis& diagnosis) {
  Json names = Json::array();
  for (const EffectCandidate& candidate : diagnosis.candidates) {
    if (diagnosis.effects.empty() || candidate.name == diagnosis.effects[0].name) continue;
    if (candidate.alike) names.push_back(candidate.name);
  }
  return names;
}

Json Direction(const Eigen::Vector3d& v) { return Json::array({v[0], v[1], v[2]}); }

Json Vectors(const Points& vectors) {
  Json list = Json::array();
  for (const auto& vector : vectors.colwise()) list.push_back(Direction(vector));
  return list;
}

Json UnexplainedJson(const Diagnosis& diagnosis) {
  if (!diagnosis.unexplained) return nullptr;
  const Unexplained& left = *diagnosis.unexplained;
  return {{"track", left.track},
          {"particle", left.particle},
          {"position", Direction(left.position)},
          {"from_s", left.first_time},
          {"to_s", left.last_time},
          {"direction", Direction(left.direction)},
          {"steadiness", left.steadiness}};
}

Json BinnedJson(const BinnedMeans& means) {
  return {{"x", means.x}, {"force_n", means.y}, {"standard_error_n", means.error}};
}

Json ResidualJson(const ResidualPattern& pattern) {
  return {{"rms_n", pattern.root_mean_square},
          {"noise_n", pattern.noise},
          {"left_m", pattern.left},
          {"constant", pattern.constant},
          {"acceleration_m_per_s2", Direction(pattern.acceleration)},
          {"with_velocity", pattern.with_velocity},
          {"with_stretch", pattern.with_stretch},
          {"over_time_n", pattern.over_time},
          {"net_n", Vectors(pattern.net)},
          {"frequency_step_hz", pattern.frequency_step},
          {"spectrum_n", pattern.spectrum},
          {"along_body", BinnedJson(pattern.along_body)},
          {"against_speed", BinnedJson(pattern.against_speed)},
          {"against_stretch", BinnedJson(pattern.against_stretch)}};
}

std::string InMillimetres(double metres) {
  return std::isfinite(metres) ? fmt::format("{:.2f} mm", 1e3 * metres) : "no data";
}

std::string DescribeGain(const BootstrapResult& gain) {
  return fmt::format("{:.2f} mm less, 95 % interval {:.2f} to {:.2f}", 1e3 * gain.mean,
                     1e3 * gain.low, 1e3 * gain.high);
}

// "mass_kg 0.052 +- 0.001, place_x_m 0.1 +- 0.003, ..." of the effect of that index.
std::string DescribeParameters(const Diagnosis& diagnosis, std::size_t effect) {
  std::size_t first = 0;
  for (std::size_t n = 0; n < effect; ++n) {
    first += static_cast<std::size_t>(diagnosis.effects[n].values.size());
  }
  const EffectValues& values = diagnosis.effects[effect];
  std::string text;
  Eigen::Index i = 0;
  for (const EffectParameter& parameter : GetEffect(values.name).parameters()) {
    text += (text.empty() ? "" : ", ") + parameter.key;
    for (int n = 0; n < parameter.count; ++n, ++i) {
      text += fmt::format(" {:.3g}", values.values[i]);
      const std::size_t at = first + static_cast<std::size_t>(i);
      if (at >= diagnosis.certainty.size()) continue;
      text += fmt::format(" ± {:.2g}", 1.96 * diagnosis.certainty[at].error);
      if (diagnosis.certainty[at].shared > 0.95) text += " (hardly told from other parameters)";
    }
  }
  return text;
}

// "; as good on these recordings: ..." or nothing.
std::string DescribeConfounded(const Diagnosis& diagnosis) {
  std::string text;
  for (const Json& name : Confounded(diagnosis)) {
    text += (text.empty() ? "as good on these recordings: " : ", ") + name.get<std::string>();
  }
  return text;
}

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

std::string Verdict(const Diagnosis& diagnosis) {
  if (diagnosis.effects.empty() && !diagnosis.unexplained) return "nothing is missing";
  std::string verdict;
  for (const EffectValues& effect : diagnosis.effects) {
    verdict += (verdict.empty() ? "the model lacks " : ", ") + effect.name;
  }
  if (!diagnosis.unexplained) return verdict;
  const Unexplained& left = *diagnosis.unexplained;
  return fmt::format(
      "{}{} above the noise are unexplained: a force, largest on particle {}, mostly from {:.2f} "
      "to "
      "{:.2f} s, then towards ({:.2f}, {:.2f}, {:.2f}), which {}",
      verdict.empty() ? "" : verdict + "; ", InMillimetres(left.track), left.particle,
      left.first_time, left.last_time, left.direction[0], left.direction[1], left.direction[2],
      left.steadiness > kSteady ? "stays" : "turns");
}

// "missing force: ...": how large it is, and what it goes along with.
std::string DescribeResidual(const Diagnosis& diagnosis) {
  const ResidualPattern &before = diagnosis.residual_before, &after = diagnosis.residual_after;
  std::string text =
      fmt::format("missing force on a node: {:.3g} mN", 1e3 * before.root_mean_square);
  if (!diagnosis.effects.empty()) {
    text += fmt::format(" before, {:.3g} mN after", 1e3 * after.root_mean_square);
  }
  return text + fmt::format(
                    " (noise makes {:.2g}){}: {:.0f} % of its square one acceleration, cosine with "
                    "the velocity {:.2f}, with the stretch {:.2f}",
                    1e3 * before.noise, diagnosis.effects.empty() ? "" : "; before",
                    100 * before.constant, before.with_velocity, before.with_stretch);
}

// "a, b", or `none`.
std::string Join(const std::vector<std::string>& names, const char* none) {
  return names.empty() ? none : fmt::format("{}", fmt::join(names, ", "));
}

std::string DescribeRecordings(const Diagnosis& diagnosis) {
  return fmt::format("fitted to {}; judged by {}", Join(diagnosis.fitted, "nothing"),
                     Join(diagnosis.judged, "frames that were not fitted"));
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

}  // namespace

std::string FormatDiagnosisJson(const Diagnosis& diagnosis) {
  Json candidates = Json::array();
  for (const EffectCandidate& candidate : diagnosis.candidates) {
    candidates.push_back(
        {{"name", candidate.name},
         {"score", candidate.score},
         {"heldout", candidate.refit ? Number(candidate.refit->held) : Json(nullptr)}});
  }
  const Json report = {
      {"recordings", {{"fit", diagnosis.fitted}, {"heldout", diagnosis.judged}}},
      {"noise_floor", diagnosis.noise_floor},
      {"before", Pair(diagnosis.before)},
      {"effects", EffectList(diagnosis)},
      {"after", Pair(diagnosis.after)},
      {"gain",
       {{"mean", diagnosis.gain.mean}, {"low", diagnosis.gain.low}, {"high", diagnosis.gain.high}}},
      {"candidates", candidates},
      {"confounded", Confounded(diagnosis)},
      {"unexplained", UnexplainedJson(diagnosis)},
      {"residual_force",
       {{"before", ResidualJson(diagnosis.residual_before)},
        {"after", ResidualJson(diagnosis.residual_after)}}}};
  return report.dump(1) + "\n";
}

std::string FormatDiagnosisText(const Diagnosis& diagnosis) {
  std::string text = DescribeRecordings(diagnosis) + "\n";
  text += fmt::format("noise floor: {}\n", InMillimetres(diagnosis.noise_floor));
  text += fmt::format("before: fit {}, held out {}\n", InMillimetres(diagnosis.before.fit),
                      InMillimetres(diagnosis.before.held));
  for (const EffectCandidate& candidate : diagnosis.candidates) {
    if (!candidate.refit) continue;
    text += fmt::format("  {:<18} takes {:5.1f} % of the misfit; held out {} ({}; p {:.2g})\n",
                        candidate.name, 100 * candidate.score, InMillimetres(candidate.refit->held),
                        DescribeGain(candidate.gain), candidate.gain.p);
  }
  for (std::size_t i = 0; i < diagnosis.effects.size(); ++i) {
    text += fmt::format("added: {} ({})\n", diagnosis.effects[i].name,
                        DescribeParameters(diagnosis, i));
  }
  const std::string confounded = DescribeConfounded(diagnosis);
  if (!confounded.empty()) text += confounded + "\n";
  text += fmt::format("after: fit {}, held out {}\n", InMillimetres(diagnosis.after.fit),
                      InMillimetres(diagnosis.after.held));
  return text + DescribeResidual(diagnosis) + "\n" + Verdict(diagnosis) + "\n";
}

std::string FormatDiagnosisPage(const Diagnosis& diagnosis, const Recording& recording,
                                const std::string& title) {
  std::string page = fmt::format(
      "<!DOCTYPE html><html lang='en'><meta charset='utf-8'><title>{0}</title><style>body{{font:"
      "16px sans-serif;max-width:60em;margin:2em auto;padding:0 1em}}td,th{{padding:.2em 1em .2em "
      "0;text-align:left}}svg{{width:100%;border:1px solid "
      "#ccc}}.plots{{display:grid;grid-template-columns:1fr 1fr;gap:"
      "1em}}.plots text{{font-size:12px}}</style><h1>{0}</h1><p>{1}.</p><p>{2}.</p>",
      title, Verdict(diagnosis), DescribeRecordings(diagnosis));
  page += fmt::format(
      "<table><tr><th>track error</th><th>fitted frames</th><th>held-out frames</th></tr>"
      "<tr><td>before</td><td>{}</td><td>{}</td></tr><tr><td>after</td><td>{}</td><td>{}</td></tr>"
      "<tr><td>noise floor</td><td colspan='2'>{}</td></tr></table><p>{}.</p>",
      InMillimetres(diagnosis.before.fit), InMillimetres(diagnosis.before.held),
      InMillimetres(diagnosis.after.fit), InMillimetres(diagnosis.after.held),
      InMillimetres(diagnosis.noise_floor), DescribeGain(diagnosis.gain));
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
    page += fmt::format("<p>Behind ±: half a 95 % interval from the curvature of the misfit{}.</p>",
                        confounded.empty() ? "" : "; " + confounded);
  }
  page += fmt::format("<h2>Forces that are missing</h2><p>{}.</p>{}", DescribeResidual(diagnosis),
                      FormatResidualPlots(diagnosis, recording));
  page +=
      "<h2>Candidates</h2><table><tr><th>effect</th><th>part of the misfit, linearised</th>"
      "<th>held out, refitted</th><th>gain</th></tr>";
  for (const EffectCandidate& candidate : diagnosis.candidates) {
    page += fmt::format("<tr><td>{}</td><td>{:.1f} %</td><td>{}</td><td>{}</td></tr>",
                        candidate.name, 100 * candidate.score,
                        candidate.refit ? InMillimetres(candidate.refit->held) : "",
                        candidate.refit ? DescribeGain(candidate.gain) : "");
  }
  return page + "</table></html>\n";
}

}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
#include "report/diagnosis_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "report/diagnosis/effect_words.h"
#include "report/diagnosis_text.h"
#include "twin/effects/effect_json.h"
#include "twin/effects/registry.h"

namespace physpring {
namespace {

using Json = nlohmann::ordered_json;

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
    Json errors = Json::object(), shared = Json::object(), unknown = Json::object();
    for (const EffectParameter& parameter : GetEffect(diagnosis.effects[n].name).parameters()) {
      Json of_error = Json::array(), of_shared = Json::array(), of_unknown = Json::array();
      for (int k = 0; k < parameter.count && i < diagnosis.certainty.size(); ++k, ++i) {
        of_error.push_back(Number(diagnosis.certainty[i].error));
        of_shared.push_back(Number(diagnosis.certainty[i].shared));
        of_unknown.push_back(Number(diagnosis.certainty[i].unknown));
      }
      const bool one = parameter.count == 1 && !of_error.empty();
      errors[parameter.key] = one ? of_error[0] : of_error;
      shared[parameter.key] = one ? of_shared[0] : of_shared;
      unknown[parameter.key] = one ? of_unknown[0] : of_unknown;
    }
    const EffectPicture picture = PictureOf(diagnosis, diagnosis.effects[n]);
    if (picture.formula) list[n]["formula"] = picture.lacks;
    list[n]["standard_errors"] = errors;
    list[n]["shared"] = shared;
    list[n]["unknown"] = unknown;
  }
  return list;
}

Json ParametersOf(const EffectValues& effect) {
  return Json::parse(EffectsToJson({effect}))[0]["parameters"];
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
  const auto located = [&](const Json& value) { return left.located ? value : Json(nullptr); };
  return {{"track", left.track},
          {"converged", left.converged},
          {"particle", located(left.particle)},
          {"position", located(Direction(left.position))},
          {"from_s", located(left.first_time)},
          {"to_s", located(left.last_time)},
          {"direction", located(Direction(left.direction))},
          {"steadiness", located(left.steadiness)}};
}

Json RankingJson(const EffectRanking& ranking) {
  Json list = Json::array();
  for (const EffectCandidate& candidate : ranking) {
    list.push_back(
        {{"name", candidate.name},
         {"score", candidate.score},
         {"heldout", candidate.refit ? Number(candidate.refit->held) : Json(nullptr)},
         {"without", candidate.refit ? Number(candidate.without) : Json(nullptr)},
         {"parameters", candidate.refit ? ParametersOf(candidate.values) : Json(nullptr)}});
  }
  return list;
}

Json BinnedJson(const BinnedMeans& means) {
  return {{"x", means.x}, {"force_n", means.y}, {"standard_error_n", means.error}};
}

Json ResidualJson(const ResidualPattern& pattern) {
  if (!pattern.converged) {
    return {{"converged", false}, {"noise_n", pattern.noise}, {"left_m", pattern.left}};
  }
  return {{"converged", true},
          {"rms_n", pattern.root_mean_square},
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

}  // namespace

std::string FormatDiagnosisJson(const Diagnosis& diagnosis) {
  Json later = Json::array();
  for (std::size_t i = 1; i < diagnosis.rankings.size(); ++i) {
    later.push_back(RankingJson(diagnosis.rankings[i]));
  }
  const Json report = {
      {"recordings",
       {{"fit", diagnosis.fitted},
        {"heldout", diagnosis.judged},
        {"before", diagnosis.before_change},
        {"resting_frames", diagnosis.resting_frames}}},
      {"noise_floor", diagnosis.noise_floor},
      {"motionless", Number(diagnosis.motionless)},
      {"before", Pair(diagnosis.before)},
      {"effects", EffectList(diagnosis)},
      {"after", Pair(diagnosis.after)},
      {"all_frames", diagnosis.all_frames ? Json(*diagnosis.all_frames) : Json(nullptr)},
      {"gain",
       {{"mean", diagnosis.gain.mean}, {"low", diagnosis.gain.low}, {"high", diagnosis.gain.high}}},
      {"candidates", RankingJson(diagnosis.rankings.at(0))},
      {"later_candidates", later},
      {"refusal", diagnosis.refusal.empty() ? Json(nullptr) : Json(diagnosis.refusal)},
      {"confounded", Confounded(diagnosis)},
      {"unexplained", UnexplainedJson(diagnosis)},
      {"residual_force",
       {{"before", ResidualJson(diagnosis.residual_before)},
        {"after", ResidualJson(diagnosis.residual_after)}}}};
  return report.dump(1) + "\n";
}

}  // namespace physpring

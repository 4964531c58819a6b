// SPDX-License-Identifier: Apache-2.0
#include "report/rollout_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>
#include <utility>

#include "rollout/statistics.h"
#include "rollout/sweep_folder.h"

namespace physpring {
namespace {

using Json = nlohmann::ordered_json;

struct LevelOutcome {
  int episodes = 0, successes = 0, problems = 0;
  int timed = 0, frames = 0;  // episodes of which the times are known, and their frames
  EpisodeSeconds seconds;     // theirs, added up
  double rate() const { return episodes == 0 ? 0 : static_cast<double>(successes) / episodes; }
};

struct Comparison {
  int reference = 0, level = 0;
  PairedVerdicts verdicts;
};

// How a policy compares with the first one at one level: on the same starts if their seeds are the
// same.
struct PolicyComparison {
  std::size_t policy = 0;
  int level = 0;
  PairedVerdicts verdicts;
};

using Verdicts = std::map<int, std::map<int, bool>>;  // by level, then episode

struct PolicyResult {
  std::map<int, LevelOutcome> levels;
  std::vector<Comparison> comparisons;  // how the other levels agree with the lowest one
};

PairedVerdicts Pair(const std::map<int, bool>& first, const std::map<int, bool>& second) {
  PairedVerdicts verdicts;
  for (const auto& [episode, success] : first) {
    const auto other = second.find(episode);
    if (other == second.end()) continue;
    int& count = success ? (other->second ? verdicts.both : verdicts.only_first)
                         : (other->second ? verdicts.only_second : verdicts.neither);
    ++count;
  }
  return verdicts;
}

Verdicts VerdictsOf(const JudgedPolicy& policy) {
  Verdicts verdicts;
  for (const EpisodeSummary& episode : policy.episodes) {
    verdicts[episode.level][episode.episode] = episode.success;
  }
  return verdicts;
}

std::vector<PolicyComparison> ComparePolicies(const std::vector<JudgedPolicy>& policies) {
  std::vector<PolicyComparison> comparisons;
  for (std::size_t i = 1; i < policies.size(); ++i) {
    const Verdicts first = VerdictsOf(policies[0]), other = VerdictsOf(policies[i]);
    for (const auto& [level, verdicts] : first) {
      if (!other.contains(level)) continue;
      comparisons.push_back({i, level, Pair(verdicts, other.at(level))});
    }
  }
  return comparisons;
}

void AddTimes(const EpisodeSeconds& seconds, int frames, LevelOutcome* level) {
  ++level->timed;
  level->frames += frames;
  level->seconds.physics += seconds.physics;
  level->seconds.policy += seconds.policy;
  level->seconds.scoring += seconds.scoring;
  level->seconds.rendering += seconds.rendering;
  level->seconds.total += seconds.total;
}

PolicyResult Count(const JudgedPolicy& policy) {
  PolicyResult result;
  for (const EpisodeSummary& episode : policy.episodes) {
    LevelOutcome& level = result.levels[episode.level];
    ++level.episodes;
    level.successes += episode.success ? 1 : 0;
    level.problems += episode.problem.empty() ? 0 : 1;
    if (episode.seconds) AddTimes(*episode.seconds, episode.frames, &level);
  }
  const Verdicts success = VerdictsOf(policy);
  if (success.empty()) return result;
  const auto& [reference, verdicts] = *success.begin();
  for (const auto& [level, other] : success) {
    if (level != reference) result.comparisons.push_back({reference, level, Pair(verdicts, other)});
  }
  return result;
}

std::string FormatLevels(const PolicyResult& result) {
  std::string text =
      fmt::format("{:>5} {:>9} {:>12} {:>15} {:>9} | s/episode {:>8} {:>7} {:>8} {:>9} | {:>8}\n",
                  "level", "episodes", "successes", "95 % interval", "problems", "physics",
                  "policy", "scoring", "rendering", "frames/s");
  for (const auto& [number, level] : result.levels) {
    const Interval interval = WilsonInterval(level.successes, level.episodes);
    const double n = std::max(1, level.timed);
    text += fmt::format(
        "{:>5} {:>9} {:>4} ({:4.1f} %) {:>6.1f} - {:4.1f} % {:>9} | {:>9.3f} {:>8.3f} {:>7.3f} "
        "{:>8.3f} {:>9.3f} | {:>8.1f}\n",
        number, level.episodes, level.successes, 100 * level.rate(), 100 * interval.low,
        100 * interval.high, level.problems, level.seconds.total / n, level.seconds.physics / n,
        level.seconds.policy / n, level.seconds.scoring / n, level.seconds.rendering / n,
        level.seconds.total > 0 ? level.frames / level.seconds.total : 0.0);
  }
  return text;
}

// `first`, `second`: names of the two that were compared.
std::string FormatVerdicts(const std::string& first, const std::string& second,
                           const PairedVerdicts& v) {
  if (v.count() == 0) return fmt::format("{} and {}: no episode in common\n", first, second);
  const std::optional<double> kappa = v.Kappa();
  return fmt::format(
      "{} and {}: {} episodes, both succeed {}, only {} {}, only {} {}, neither {}; agreement "
      "{:.1f} %, kappa {}, McNemar p = {:.3g}\n",
      first, second, v.count(), v.both, first, v.only_first, second, v.only_second, v.neither,
      100 * v.Agreement(), kappa ? fmt::format("{:.2f}", *kappa) : "-", v.McNemar());
}

std::string FormatComparison(const Comparison& comparison) {
  return FormatVerdicts(fmt::format("level {}", comparison.reference),
                        fmt::format("level {}", comparison.level), comparison.verdicts);
}

// Success rates of the policies at two levels.
struct Ranking {
  int reference = 0, level = 0;
  std::vector<double> reference_rates, rates;
};

std::vector<Ranking> Rank(const std::vector<PolicyResult>& results) {
  std::set<int> levels;
  for (const PolicyResult& result : results) {
    for (const auto& [level, unused] : result.levels) levels.insert(level);
  }
  std::vector<Ranking> rankings;
  for (const int level : levels) {
    if (level == *levels.begin()) continue;
    Ranking ranking{*levels.begin(), level, {}, {}};
    for (const PolicyResult& result : results) {
      if (!result.levels.contains(level) || !result.levels.contains(ranking.reference)) continue;
      ranking.reference_rates.push_back(result.levels.at(ranking.reference).rate());
      ranking.rates.push_back(result.levels.at(level).rate());
    }
    if (ranking.rates.size() >= 2) rankings.push_back(ranking);
  }
  return rankings;
}

Json OrNull(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json ToJson(int number, const LevelOutcome& level) {
  const Interval interval = WilsonInterval(level.successes, level.episodes);
  const EpisodeSeconds& s = level.seconds;
  const double n = std::max(1, level.timed);
  return {{"level", number},
          {"episodes", level.episodes},
          {"successes", level.successes},
          {"rate", level.rate()},
          {"wilson", {interval.low, interval.high}},
          {"problems", level.problems},
          {"seconds_per_episode",
           {{"total", s.total / n},
            {"physics", s.physics / n},
            {"policy", s.policy / n},
            {"scoring", s.scoring / n},
            {"rendering", s.rendering / n}}},
          {"frames_per_second", s.total > 0 ? Json(level.frames / s.total) : Json()}};
}

// `first`, `second`: what the two that were compared are called in keys.
void AddVerdicts(const char* first, const char* second, const PairedVerdicts& v, Json* json) {
  json->update({{"episodes", v.count()},
                {"both", v.both},
                {std::string("only_") + first, v.only_first},
                {std::string("only_") + second, v.only_second},
                {"neither", v.neither},
                {"agreement", v.count() > 0 ? Json(v.Agreement()) : Json()},
                {"kappa", OrNull(v.Kappa())},
                {"mcnemar_p", v.count() > 0 ? Json(v.McNemar()) : Json()}});
}

Json ToJson(const Comparison& comparison) {
  Json json = {{"reference", comparison.reference}, {"level", comparison.level}};
  AddVerdicts("reference", "level", comparison.verdicts, &json);
  return json;
}

Json ToJson(const JudgedPolicy& policy, const PolicyResult& result) {
  Json json = {{"task", policy.task}, {"policy", policy.policy}};
  for (const auto& [number, level] : result.levels) json["levels"].push_back(ToJson(number, level));
  json["comparisons"] = Json::array();
  for (const Comparison& comparison : result.comparisons) {
    json["comparisons"].push_back(ToJson(comparison));
  }
  json["episodes"] = Json::array();
  for (const EpisodeSummary& episode : policy.episodes) {
    json["episodes"].push_back({{"episode", episode.episode},
                                {"level", episode.level},
                                {"success", episode.success},
                                {"met_frames", episode.met_frames},
                                {"value", episode.value},
                                {"problem", episode.problem}});
  }
  return json;
}

std::vector<PolicyResult> CountAll(const std::vector<JudgedPolicy>& policies) {
  std::vector<PolicyResult> results;
  for (const JudgedPolicy& policy : policies) results.push_back(Count(policy));
  return results;
}

}  // namespace

std::vector<JudgedPolicy> ReadPolicies(const std::vector<std::string>& folders) {
  std::map<std::string, std::size_t> known;  // by identity
  std::vector<JudgedPolicy> policies;
  std::set<std::tuple<std::string, int, int>> seen;
  for (const std::string& folder : folders) {
    const StoredSweep stored = ReadSweepFolder(folder);
    const auto [place, added] = known.try_emplace(stored.identity, policies.size());
    if (added) policies.push_back({stored.task, stored.policy, {}});
    for (const EpisodeSummary& episode : stored.episodes) {
      if (!seen.insert({stored.identity, episode.level, episode.episode}).second) continue;
      policies[place->second].episodes.push_back(episode);
    }
  }
  for (JudgedPolicy& policy : policies) {
    std::sort(policy.episodes.begin(), policy.episodes.end(), [](const auto& a, const auto& b) {
      return std::pair(a.episode, a.level) < std::pair(b.episode, b.level);
    });
  }
  return policies;
}

std::string FormatTables(const std::vector<JudgedPolicy>& policies) {
  const std::vector<PolicyResult> results = CountAll(policies);
  std::string text;
  for (std::size_t i = 0; i < policies.size(); ++i) {
    text += fmt::format("{}, policy {}\n{}", policies[i].task, policies[i].policy,
                        FormatLevels(results[i]));
    for (const Comparison& comparison : results[i].comparisons) {
      text += FormatComparison(comparison);
    }
  }
  for (const PolicyComparison& comparison : ComparePolicies(policies)) {
    text += fmt::format("level {}: ", comparison.level) +
            FormatVerdicts("policy 1", fmt::format("policy {}", comparison.policy + 1),
                           comparison.verdicts);
  }
  for (const Ranking& ranking : Rank(results)) {
    const std::optional<double> pearson = Pearson(ranking.reference_rates, ranking.rates);
    text += fmt::format("level {} ranks {} policies against level {}: MMRV {:.3f}, Pearson {}\n",
                        ranking.level, ranking.rates.size(), ranking.reference,
                        MeanMaximumRankViolation(ranking.reference_rates, ranking.rates),
                        pearson ? fmt::format("{:.3f}", *pearson) : "-");
  }
  return text;
}

std::string FormatJson(const std::vector<JudgedPolicy>& policies) {
  const std::vector<PolicyResult> results = CountAll(policies);
  Json json = {{"policies", Json::array()},
               {"policy_comparisons", Json::array()},
               {"rankings", Json::array()}};
  for (std::size_t i = 0; i < policies.size(); ++i) {
    json["policies"].push_back(ToJson(policies[i], results[i]));
  }
  for (const PolicyComparison& comparison : ComparePolicies(policies)) {
    Json entry = {{"policy", comparison.policy}, {"level", comparison.level}};
    AddVerdicts("first", "policy", comparison.verdicts, &entry);
    json["policy_comparisons"].push_back(entry);
  }
  for (const Ranking& ranking : Rank(results)) {
    json["rankings"].push_back(
        {{"reference", ranking.reference},
         {"level", ranking.level},
         {"policies", ranking.rates.size()},
         {"mmrv", MeanMaximumRankViolation(ranking.reference_rates, ranking.rates)},
         {"pearson", OrNull(Pearson(ranking.reference_rates, ranking.rates))}});
  }
  return json.dump(1) + "\n";
}

}  // namespace physpring

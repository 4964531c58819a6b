// SPDX-License-Identifier: Apache-2.0
// Does the diagnosis find what is missing? Bodies of tendons in MuJoCo, each with one undeclared
// effect or with none, are diagnosed; every case is a line of a file, and what is in the file
// already is not done again:
//   recovery_study cases.jsonl [--clean 100] [--seeds 1] [--share I/N] [--only TEXT]
// then prints, from all cases in the file, how often each effect was ranked first and was added,
// and what was added instead.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <ctime>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "bench/study_recordings.h"
#include "diagnosis/diagnosis.h"
#include "trainer/bodies/candidates.h"
#include "twin/error.h"

namespace physpring {
namespace {

using Json = nlohmann::json;

struct Case {
  StudyBody body;
  std::string effect;
  double noise;  // m
  int seed;

  std::string Name() const {
    constexpr const char* kBodies[] = {"rope", "sheet", "block"};
    return fmt::format("{} {} {} {}", kBodies[static_cast<int>(body)], effect, noise, seed);
  }
};

std::vector<Case> Cases(int seeds, int clean) {
  std::vector<Case> cases;
  const std::vector<StudyBody> bodies = {StudyBody::kRope, StudyBody::kSheet, StudyBody::kBlock};
  for (int seed = 0; seed < seeds; ++seed) {
    for (double noise : {3e-4, 1e-3}) {
      for (StudyBody body : bodies) {
        for (const std::string& effect : StudyEffects()) {
          cases.push_back({body, effect, noise, seed});
        }
      }
    }
  }
  for (int i = 0; i < clean; ++i) {
    cases.push_back(
        {bodies[static_cast<std::size_t>(i % 3)], "none", i % 2 == 0 ? 3e-4 : 1e-3, 1000 + i});
  }
  return cases;
}

// A twin as training leaves it: what counts is its object, everything else is open again.
Twin TwinOf(const Recording& recording) {
  Twin twin;
  const Body candidate = CandidateBodies(recording, {}).front();
  twin.levels.push_back({StartSystem(recording, candidate, 8), {}, 1000});
  twin.points = recording.point_count();
  twin.fps = recording.fps;
  twin.controller_velocity = candidate.controller_velocity;
  twin.trained_on.push_back({recording.name, recording.hash, recording.train_frames});
  return twin;
}

// Where, when and in which direction something remains; null where nothing does.
Json UnexplainedJson(const std::optional<Unexplained>& left) {
  if (!left) return nullptr;
  return {{"track", left->track},
          {"particle", left->particle},
          {"from_s", left->first_time},
          {"to_s", left->last_time},
          {"direction", {left->direction[0], left->direction[1], left->direction[2]}},
          {"steadiness", left->steadiness}};
}

// Cosine between two series of vectors; null where one is 0.
Json Cosine(const Points& p, const Points& q) {
  const double norms = p.norm() * q.norm();
  return norms > 0 ? Json(p.cwiseProduct(q).sum() / norms) : Json();
}

Json Run(const Case& one) {
  const std::uint64_t seed = std::hash<std::string>()(one.Name());
  const MadeRecordings made = MakeWithEffect(one.body, one.effect, one.noise, seed);
  DiagnosisOptions options;
  options.most_effects = 1;
  const std::clock_t begin = std::clock();
  const Diagnosis diagnosis =
      Diagnose(TwinOf(made.fit), {.fit = {made.fit}, .held_out = {made.other}}, options);
  const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  Json ranking = Json::array();  // of what was refitted
  for (const EffectCandidate& candidate : diagnosis.rankings.at(0)) {
    if (candidate.refit) {
      ranking.push_back({{"name", candidate.name},
                         {"held", candidate.refit->held},
                         {"trace", candidate.score},
                         {"p", candidate.gain.p}});
    }
  }
  return {{"case", one.Name()},
          {"ranking", ranking},
          {"effect", one.effect},
          {"noise", one.noise},
          {"found", diagnosis.effects.empty() ? "none" : diagnosis.effects[0].name},
          {"unexplained", UnexplainedJson(diagnosis.unexplained)},
          {"net_force_cosine", Cosine(diagnosis.residual_before.net, made.outside)},
          {"displacement", made.displacement},
          {"noise_floor", diagnosis.noise_floor},
          {"before", diagnosis.before.held},
          {"after", diagnosis.after.held},
          {"cpu_s", seconds}};
}

void PrintTable(const std::vector<Json>& cases) {
  std::map<std::string, std::vector<Json>> by_effect;
  for (const Json& one : cases) by_effect[one["effect"]].push_back(one);
  fmt::print(
      "| effect | cases | moved by, mm | ranked first | added | added instead | unexplained | "
      "before, mm | after, mm | CPU, s |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (const auto& [effect, rows] : by_effect) {
    int first = 0, found = 0, unexplained = 0;
    double before = 0, after = 0, moved = 0, seconds = 0;
    std::map<std::string, int> instead;
    for (const Json& row : rows) {
      const Json& ranking = row["ranking"];
      first += !ranking.empty() && ranking[0]["name"] == effect ? 1 : 0;
      if (row["found"] == effect) {
        ++found;
      } else {
        ++instead[row["found"]];
      }
      unexplained += row["unexplained"].is_null() ? 0 : 1;
      before += row["before"].get<double>(), after += row["after"].get<double>();
      moved += row["displacement"].get<double>(), seconds += row["cpu_s"].get<double>();
    }
    std::string others;
    for (const auto& [name, count] : instead) {
      others += fmt::format("{}{} {}", others.empty() ? "" : ", ", count, name);
    }
    const double per = 1 / static_cast<double>(rows.size());
    fmt::print("| {} | {} | {:.1f} | {} | {} | {} | {} | {:.2f} | {:.2f} | {:.1f} |\n", effect,
               rows.size(), 1e3 * moved * per, first, found, others, unexplained,
               1e3 * before * per, 1e3 * after * per, seconds * per);
  }
}

void Study(const std::string& path, int seeds, int clean, const std::string& share,
           const std::string& only) {
  std::vector<Json> done;
  std::set<std::string> known;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    done.push_back(Json::parse(line));
    known.insert(done.back()["case"]);
  }
  int index = 0, of = 1;
  if (!share.empty()) {
    index = std::stoi(share);
    of = std::stoi(share.substr(share.find('/') + 1));
  }
  const std::vector<Case> cases = Cases(seeds, clean);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    if (static_cast<int>(i) % of != index || known.contains(cases[i].Name())) continue;
    if (cases[i].Name().find(only) == std::string::npos) continue;
    const Json row = Run(cases[i]);
    std::ofstream(path, std::ios::app) << row.dump() << "\n";
    fmt::print(stderr, "{}\n", row.dump());
    done.push_back(row);
  }
  PrintTable(done);
}

}  // namespace
}  // namespace physpring

int main(int argc, char** argv) {
  CLI::App app("How often the diagnosis finds what is missing.");
  std::string path, share, only;
  int clean = 100, seeds = 1;
  app.add_option("cases", path, "file of cases, one JSON object a line")->required();
  app.add_option("--clean", clean, "cases without an effect");
  app.add_option("--seeds", seeds, "cases of each effect, body and noise");
  app.add_option("--share", share, "only every Nth case, from the Ith on: I/N");
  app.add_option("--only", only, "only cases whose name (body effect noise seed) has this in it");
  CLI11_PARSE(app, argc, argv);
  try {
    physpring::Study(path, seeds, clean, share, only);
  } catch (const physpring::Error& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
  return 0;
}

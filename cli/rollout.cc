// SPDX-License-Identifier: Apache-2.0
// physpring rollout: a policy on a task, episode after episode -> successes.
// physpring merge: finished episodes of one sweep or several -> the same tables.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/message.h"
#include "cli/option_values.h"
#include "cli/output_files.h"
#include "cli/picture_words.h"
#include "cli/progress.h"
#include "cli/warnings.h"
#include "report/rollout_report.h"
#include "rollout/camera_thread.h"
#include "rollout/make_policy.h"
#include "rollout/mujoco_library.h"
#include "rollout/plugin_library.h"
#include "rollout/sweep.h"
#include "twin/atomic_file.h"
#include "twin/error.h"

namespace physpring {
namespace {

constexpr Word<bool> kStateWords[] = {{"full", true}, {"actions", false}};

struct RolloutArguments {
  std::string task, json, save_scene, shard;
  std::string video;
  PictureQuality quality = PictureQuality::kFast;
  std::vector<std::string> cameras;  // those that videos show
  int films = 1;                     // so many episodes are filmed, from the first one on
  SweepOptions sweep;
};

// The folder of a task that is named by its folder, or by a file in it.
std::string FolderOf(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) return path;
  const std::string folder = std::filesystem::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

// Takes "3/8" as shard and shards.
CLI::Validator IsShard(SweepOptions* sweep) {
  return CLI::Validator(
      [sweep](std::string& text) {
        int shard = 0, shards = 0;
        const char* last = text.data() + text.size();
        const auto [slash, bad_shard] = std::from_chars(text.data(), last, shard);
        const bool is_pair = bad_shard == std::errc() && slash != last && *slash == '/';
        const auto [end, bad_shards] = std::from_chars(is_pair ? slash + 1 : last, last, shards);
        if (bad_shards != std::errc() || end != last || shard < 1 || shard > shards) {
          return "takes i/n with i from 1 to n, not '" + text + "'";
        }
        sweep->shard = shard;
        sweep->shards = shards;
        return std::string();
      },
      "");
}

CLI::Validator TakesPolicy() {
  return CLI::Validator(
      [](std::string& text) {
        return IsPolicy(text)
                   ? ""
                   : "takes scripted, random, replay:PATH or ws://HOST:PORT, not '" + text + "'";
      },
      "");
}

// Writes the report and prints the tables.
void Report(const std::vector<JudgedPolicy>& policies, const std::string& json) {
  if (!json.empty()) WriteFileAtomically(json, FormatJson(policies));
  fmt::print("{}", FormatTables(policies));
}

// out.mp4, or out_level3_00007.mp4 where there are several.
std::string VideoPath(const RolloutArguments& arguments, int level, int episode) {
  const SweepOptions& sweep = arguments.sweep;
  if (sweep.levels.size() == 1 && std::min(arguments.films, sweep.episodes) == 1) {
    return arguments.video;
  }
  const std::filesystem::path path = arguments.video;
  return (path.parent_path() / fmt::format("{}_level{}_{:05}{}", path.stem().string(), level,
                                           episode, path.extension().string()))
      .string();
}

// Adds cameras where the policy looks or a video is wanted.
void AddCameras(const RolloutArguments& arguments, const Task& task, SweepHooks* hooks) {
  hooks->prepare = [quality = arguments.quality, &task](mjModel* model) {
    PreparePictures(quality, task.width, task.height, model);
  };
  hooks->make_viewer = [&arguments](const TaskModel& model, int episode,
                                    bool images) -> std::unique_ptr<Viewer> {
    const bool filmed =
        !arguments.video.empty() && episode < arguments.sweep.first + arguments.films;
    if (!filmed && !images) return nullptr;
    const std::string video = filmed ? VideoPath(arguments, model.level, episode) : "";
    CameraOptions options{arguments.quality, video, arguments.cameras};
    const SweepOptions& sweep = arguments.sweep;
    if (sweep.vary_looks) {
      options.looks = StartOf(*model.task, sweep.seed, episode, sweep.disturbance).seed;
    }
    return MakeCameraThread(model, options);
  };
}

void ExpectDifferent(const std::vector<int>& levels) {
  std::set<int> seen;
  for (const int level : levels) {
    if (!seen.insert(level).second) throw Error(fmt::format("--level: {} is given twice", level));
  }
}

// Says why episodes ended early, each reason once.
void WarnOfProblems(const std::vector<EpisodeSummary>& episodes) {
  std::map<std::string, int> problems;
  for (const EpisodeSummary& episode : episodes) {
    if (!episode.problem.empty()) ++problems[episode.problem];
  }
  for (const auto& [problem, count] : problems) {
    Tell("warning: {} of {} episodes ended early: {}\n", count, episodes.size(), problem);
  }
}

// A sweep in which nothing went as it should is no result.
void ExpectSomeWithoutProblem(const std::vector<EpisodeSummary>& episodes) {
  const auto has_problem = [](const EpisodeSummary& one) { return !one.problem.empty(); };
  if (episodes.empty() || !std::all_of(episodes.begin(), episodes.end(), has_problem)) return;
  throw Error(fmt::format("all {} episodes ended with a problem; the first: {}", episodes.size(),
                          episodes[0].problem));
}

void Run(const RolloutArguments& arguments) {
  const PolicyChoice& policy = arguments.sweep.policy;
  if (!policy.adapter.empty() && !policy.text.starts_with("ws://")) {
    throw Error("--policy-adapter is for a policy server (--policy ws://HOST:PORT)");
  }
  ExpectMujoco();
  LoadPluginLibrary();
  const std::string folder = FolderOf(arguments.task);
  const Task task = ReadTask(folder);
  std::vector<std::string> inputs = task.levels;
  inputs.insert(inputs.end(), {folder + "/task.json", task.scene});
  ExpectOutputs({arguments.json, arguments.save_scene, arguments.video}, inputs);
  ExpectDifferent(arguments.sweep.levels);
  if (!arguments.save_scene.empty()) {
    WriteFileAtomically(arguments.save_scene,
                        FormatSceneFile(task, arguments.sweep.levels.front()));
  }
  const SweepOptions& options = arguments.sweep;
  const InterruptWatch watch;
  Progress progress(0);
  int successes = 0, judged = 0;
  SweepHooks hooks;
  AddCameras(arguments, task, &hooks);
  hooks.stop = [&] { return watch.signal() != 0; };
  hooks.report = [&](const EpisodeSummary& episode, int done, int all) {
    successes += episode.success ? 1 : 0;
    ++judged;
    progress.Show(
        static_cast<double>(done) / all,
        fmt::format("episode {} of {}, {} of {} succeeded", done, all, successes, judged));
  };
  const Sweep sweep = RunSweep(task, options, hooks);
  PrintWarnings(sweep.warnings);
  WarnOfProblems(sweep.episodes);
  if (!sweep.complete) {
    Tell("physpring: stopped; {} finished episodes are {}\n", sweep.episodes.size(),
         options.folder.empty() ? "lost, because there is no --output"
                                : "kept in " + options.folder);
    throw Interrupted{watch.signal()};
  }
  if (sweep.skipped > 0) {
    fmt::print("{} episodes were finished before, in {}\n", sweep.skipped, options.folder);
  }
  Report({{task.name, options.policy.text, sweep.episodes}}, arguments.json);
  ExpectSomeWithoutProblem(sweep.episodes);
}

void AddSweepOptions(CLI::App* command, RolloutArguments* arguments) {
  SweepOptions& sweep = arguments->sweep;
  command->add_option("--level", sweep.levels, "levels of the twin, as 0,3: the same episodes")
      ->delimiter(',')
      ->check(WholeNumberBetween(0, 1000))
      ->type_name("N,...")
      ->default_str("0");
  command
      ->add_option("--policy", sweep.policy.text,
                   "scripted (the task's own), random, replay:PATH (a file, or the --output of an "
                   "earlier run), or ws://HOST:PORT (a server with openpi's protocol)")
      ->check(TakesPolicy())
      ->type_name("POLICY")
      ->capture_default_str();
  command
      ->add_option("--policy-adapter", sweep.policy.adapter,
                   "how a policy server names and arranges what it is asked with and what it "
                   "answers; default: the task's, or plain")
      ->check(CLI::ExistingFile)
      ->type_name("FILE");
  command
      ->add_option("--patience", sweep.policy.patience.answer,
                   "longest that a policy server may take for an answer")
      ->check(NumberBetween(0.001, 1e6))
      ->type_name("SECONDS")
      ->capture_default_str();
  command
      ->add_option(
          "--first-patience", sweep.policy.patience.first_answer,
          "the same for the first answer of an episode, before which a model may be compiled")
      ->check(NumberBetween(0.001, 1e6))
      ->type_name("SECONDS")
      ->capture_default_str();
  command
      ->add_option("--server-wait", sweep.policy.patience.wait,
                   "longest to wait for a policy server that cannot be reached")
      ->check(NumberBetween(0, 1e6))
      ->type_name("SECONDS")
      ->capture_default_str();
  command->add_option("--episodes", sweep.episodes, "how many")
      ->check(WholeNumberBetween(1, 1000000))
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--first", sweep.first, "number of the first episode")
      ->check(WholeNumberBetween(0, 1000000))
      ->type_name("N")
      ->capture_default_str();
  AddSeed(command, &sweep.seed, "of starts and policies");
  command
      ->add_option("--action-noise", sweep.disturbance.action,
                   "standard deviation of an error of the hand's x and y, constant in an episode")
      ->check(NumberBetween(0, 1))
      ->type_name("METRES")
      ->capture_default_str();
  command
      ->add_option("--perturb", sweep.disturbance.start,
                   "move the object's start by so much and change nothing else: for A/A controls")
      ->check(NumberBetween(0, 1))
      ->type_name("METRES")
      ->capture_default_str();
  command->add_flag("--vary-looks", sweep.vary_looks,
                    "each episode has other colours, lights and places of cameras, by its seed");
  AddThreads(command, &sweep.threads, "one episode each");
  command->add_option("--shard", arguments->shard, "run only every n-th episode, from the i-th on")
      ->check(IsShard(&sweep))
      ->type_name("I/N");
}

void AddPictureOptions(CLI::App* command, RolloutArguments* arguments) {
  CLI::Option* video =
      command
          ->add_option(
              "--video", arguments->video,
              "film the first episode (.mp4, or _%04d.png for a picture a frame); needs ffmpeg")
          ->type_name("FILE");
  command->add_option("--films", arguments->films, "film so many episodes")
      ->check(WholeNumberBetween(1, 1000000))
      ->needs(video)
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--cameras", arguments->cameras,
                   "in the video, side by side; default: the first one of the task")
      ->delimiter(',')
      ->needs(video)
      ->type_name("NAME,...");
  AddChoice(command, "--quality", &arguments->quality, kQualityWords,
            "of pictures; high: shadows, smooth edges, round shapes");
}

}  // namespace

void AddRolloutCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "rollout", "Runs a policy on a task, episode after episode, and counts successes.");
  const auto arguments = std::make_shared<RolloutArguments>();
  command
      ->add_option("task", arguments->task,
                   "folder with task.json; an exported scene is moved by physpring replay")
      ->required()
      ->type_name("TASK");
  AddSweepOptions(command, arguments.get());
  command
      ->add_option("-o,--output", arguments->sweep.folder,
                   "keep episodes here; those that are finished there are not run again")
      ->type_name("DIR");
  AddChoice(command, "--states", &arguments->sweep.states, kStateWords,
            "what is kept: states of all frames, or only actions");
  AddPictureOptions(command, arguments.get());
  command->add_option("--json", arguments->json, "report to write")->type_name("FILE");
  command
      ->add_option("--save-scene", arguments->save_scene,
                   "write an MJCF file of the scene with the first of the levels in it")
      ->type_name("FILE.xml");
  command->callback([arguments] { Run(*arguments); });
}

void AddMergeCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "merge",
      "Puts finished episodes of shards together and compares policies: the tables of rollout.");
  struct MergeArguments {
    std::vector<std::string> folders;
    std::string json;
  };
  const auto arguments = std::make_shared<MergeArguments>();
  command->add_option("folders", arguments->folders, "written by rollout --output")
      ->required()
      ->type_name("DIR...");
  command->add_option("--json", arguments->json, "report to write")->type_name("FILE");
  command->callback([arguments] {
    ExpectOutputs({arguments->json}, {});
    Report(ReadPolicies(arguments->folders), arguments->json);
  });
}

}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
#include "rollout/make_policy.h"

#include <filesystem>

#include "rollout/episode_files.h"
#include "rollout/policies/random.h"
#include "rollout/policies/registry.h"
#include "rollout/policies/replay.h"
#include "rollout/policies/websocket.h"
#include "twin/error.h"
#include "twin/quote.h"

namespace physpring {
namespace {

constexpr std::string_view kReplay = "replay:", kServer = "ws://";

}  // namespace

bool IsPolicy(const std::string& text) {
  return text == "scripted" || text == "random" ||
         (text.starts_with(kReplay) && text.size() > kReplay.size()) || text.starts_with(kServer);
}

std::string AdapterOf(const Task& task, const PolicyChoice& choice) {
  if (!choice.text.starts_with(kServer)) return "";
  return choice.adapter.empty() ? task.policy_adapter : choice.adapter;
}

std::unique_ptr<Policy> MakePolicy(const Task& task, const PolicyChoice& choice, int level,
                                   int episode) {
  const std::string& text = choice.text;
  if (text == "scripted") return MakeScriptedPolicy(task);
  if (text == "random") return MakeRandomPolicy(task);
  if (text.starts_with(kReplay)) {
    const std::string path = text.substr(kReplay.size());
    const bool folder = std::filesystem::is_directory(path);
    return MakeReplayPolicy(task, folder ? EpisodePath(path, level, episode) + ".npz" : path);
  }
  if (text.starts_with(kServer)) {
    const std::string file = AdapterOf(task, choice);
    const PolicyAdapter adapter = file.empty() ? PlainAdapter(task) : ReadPolicyAdapter(file, task);
    return MakeWebsocketPolicy(task, adapter, text, choice.patience);
  }
  throw Error("policy " + Quote(text) +
              ": expected scripted, random, replay:FILE or ws://HOST:PORT");
}

}  // namespace physpring

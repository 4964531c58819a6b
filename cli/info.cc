// SPDX-License-Identifier: Apache-2.0
// physpring info: what is in a recording or a twin.
#include <fmt/format.h>

#include <memory>

#include "cli/commands.h"
#include "cli/output_files.h"
#include "cli/warnings.h"
#include "jobs/checkpoint.h"
#include "report/info_text.h"
#include "twin/atomic_file.h"
#include "twin/error.h"
#include "twin/npz.h"

namespace physpring {
namespace {

using Json = nlohmann::ordered_json;

struct Kind {
  bool is_twin, is_recording;
};

// Holds the arrays no longer than it looks at them.
Kind KindOf(const std::string& path) {
  const Npz arrays = ReadNpz(path);
  return {arrays.contains("meta"), arrays.contains("points") || arrays.contains("surface")};
}

// Prints what `path` holds and returns it as JSON.
Json Inspect(const std::string& path) {
  const Kind kind = KindOf(path);
  if (kind.is_twin) {
    const Twin twin = ReadTwin(path);
    fmt::print("{}: a twin named {} with {} {}\n{}", path, twin.name, twin.levels.size(),
               twin.levels.size() == 1 ? "level" : "levels", DescribeTwin(twin));
    WarnOfTraining(twin, path);
    Json json = TwinToJson(twin);
    json["finished"] = IsFinished(twin);
    return json;
  }
  if (kind.is_recording) {
    const Recording recording = ReadRecordingOrClouds(path);
    fmt::print("{}: a recording\n{}", path, DescribeRecording(recording));
    PrintRemarks({&recording, 1});
    return RecordingToJson(recording);
  }
  throw Error(fmt::format(
      "{}: has neither an array 'points' or 'surface' as a recording nor an array 'meta' as a twin",
      path));
}

}  // namespace

void AddInfoCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("info", "Says what is in a recording or a twin.");
  struct InfoArguments {
    std::string file, json;
  };
  const auto arguments = std::make_shared<InfoArguments>();
  command->add_option("file", arguments->file, "recording or twin")->required()->type_name("FILE");
  command->add_option("--json", arguments->json, "write it as JSON, too")->type_name("FILE.json");
  command->callback([arguments] {
    ExpectOutputs({arguments->json}, {arguments->file});
    Json json = Inspect(arguments->file);
    if (arguments->json.empty()) return;
    json["file"] = arguments->file;
    // a file name need not be UTF-8
    WriteFileAtomically(arguments->json,
                        json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
  });
}

}  // namespace physpring

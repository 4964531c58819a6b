// SPDX-License-Identifier: Apache-2.0
#include "rollout/policies/policy_adapter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "rollout/task_fields.h"
#include "twin/json_fields.h"
#include "twin/quote.h"

namespace physpring {
namespace {

constexpr int kMostNumbers = 100000;

bool HoldsImage(const RequestField& field) {
  return field.image || std::any_of(field.fields.begin(), field.fields.end(), HoldsImage);
}

ImageField ReadImage(const JsonFields& fields, const Task& task) {
  fields.ExpectOnly({"camera", "size", "mirror", "layout"});
  ImageField image{.camera = fields.Text("camera")};
  if (std::find(task.cameras.begin(), task.cameras.end(), image.camera) == task.cameras.end()) {
    fields.Fail("camera", fmt::format("holds {}, which is not among the cameras of task.json",
                                      Quote(image.camera)));
  }
  if (fields.Has("size")) {
    const std::vector<double> size = NumbersBetween(fields, "size", 1, 4096);
    if (size.size() != 2 || size[0] != std::floor(size[0]) || size[1] != std::floor(size[1])) {
      fields.Fail("size", "must be two whole numbers, width and height");
    }
    image.width = static_cast<int>(size[0]);
    image.height = static_cast<int>(size[1]);
  }
  if (fields.Has("mirror")) image.mirror = fields.Flag("mirror");
  if (fields.Has("layout")) {
    const std::string layout = fields.Text("layout");
    if (layout != "hwc" && layout != "chw") fields.Fail("layout", "must be hwc or chw");
    image.colours_first = layout == "chw";
  }
  return image;
}

// A part may be given by its name alone.
JsonFields PartFields(const JsonFields& fields, const std::string& key, std::size_t index) {
  const nlohmann::ordered_json& part = fields.json().at(key).at(index);
  nlohmann::ordered_json object = {{"part", part}};
  if (part.is_object()) object = part;
  return fields.With(fmt::format("{}[{}]", key, index), object);
}

std::size_t PartCount(const JsonFields& fields, const std::string& key) {
  const auto found = fields.json().find(key);
  if (found == fields.json().end() || !found->is_array() || found->empty()) {
    fields.Fail(key, "must be a list of parts");
  }
  return found->size();
}

std::vector<RequestField> ReadRequest(const JsonFields& fields, const Task& task) {
  std::vector<RequestField> request;
  for (const auto& [key, value] : fields.json().items()) {
    RequestField field{.key = key};
    if (value == "prompt") {
      field.is_prompt = true;
    } else if (value.is_array()) {
      for (std::size_t i = 0; i < PartCount(fields, key); ++i) {
        field.state.push_back(ReadStatePart(PartFields(fields, key, i), task));
      }
    } else if (value.is_object() && value.contains("camera")) {
      field.image = ReadImage(fields.Object(key), task);
    } else if (value.is_object()) {
      field.fields = ReadRequest(fields.Object(key), task);
    } else {
      fields.Fail(key, "must be \"prompt\", a picture, a list of parts of the state, or an object");
    }
    request.push_back(std::move(field));
  }
  return request;
}

// What a part of an action tells; two parts must not tell the same.
std::string TellsOf(const ActionPart& part) {
  if (part.name.starts_with("position")) return "where the hand is";
  if (part.name.starts_with("quaternion") || part.name.starts_with("axis_angle")) {
    return "how the hand is turned";
  }
  return part.name.starts_with("joint") ? "the joints" : part.name;
}

void ExpectSense(const std::vector<ActionPart>& parts, const JsonFields& fields) {
  std::set<std::string> told;
  for (const ActionPart& part : parts) {
    if (part.name != "unused" && !told.insert(TellsOf(part)).second) {
      fields.Fail("action", fmt::format("tells {} twice", TellsOf(part)));
    }
  }
  if (told.empty()) fields.Fail("action", "moves nothing");
  if (told.contains("robot") && told.size() > 1) {
    fields.Fail("action", "has the part robot, which tells everything, and others");
  }
}

ActionLayout ReadAction(const JsonFields& fields, const Task& task) {
  ActionLayout action;
  for (std::size_t i = 0; i < PartCount(fields, "action"); ++i) {
    action.parts.push_back(ReadActionPart(PartFields(fields, "action", i), task.robot));
  }
  ExpectSense(action.parts, fields);
  if (SizeOf(action, task.robot) > kMostNumbers) fields.Fail("action", "has too many numbers");
  if (fields.Has("clip")) action.clip = PositiveNumber(fields, "clip", 1e6);
  if (fields.Has("deltas_from")) {
    const std::string from = fields.Text("deltas_from");
    if (from != "state" && from != "command") {
      fields.Fail("deltas_from", "must be state or command");
    }
    action.from_command = from == "command";
  }
  return action;
}

}  // namespace

bool PolicyAdapter::NeedsImages() const {
  return std::any_of(request.begin(), request.end(), HoldsImage);
}

PolicyAdapter PlainAdapter(const Task& task) {
  RequestField images{.key = "images"};
  for (const std::string& camera : task.cameras) {
    images.fields.push_back({.key = camera, .image = ImageField{.camera = camera}});
  }
  PolicyAdapter adapter;
  adapter.request = {std::move(images),
                     {.key = "state", .state = {{.name = "robot"}}},
                     {.key = "prompt", .is_prompt = true}};
  adapter.action.parts = {{.name = "robot"}};
  return adapter;
}

PolicyAdapter ReadPolicyAdapter(const std::string& file, const Task& task) {
  const JsonFields fields = ReadJsonFile(file);
  fields.ExpectOnly({"request", "action", "clip", "deltas_from", "execute", "ensemble",
                     "frames_per_action", "base", "tool"});
  PolicyAdapter adapter;
  adapter.request = ReadRequest(fields.Object("request"), task);
  if (adapter.request.empty()) fields.Fail("request", "is empty");
  adapter.action = ReadAction(fields, task);
  if (fields.Has("base")) adapter.frames.base = ReadPose(fields.Object("base"));
  if (fields.Has("tool")) adapter.frames.tool = ReadPose(fields.Object("tool"));
  if (fields.Has("execute")) adapter.chunks.execute = CountBetween(fields, "execute", 1, 10000);
  if (fields.Has("ensemble")) {
    adapter.chunks.ensemble = NumberBetween(fields, "ensemble", -100, 100);
    if (fields.Has("execute")) fields.Fail("execute", "does not go with ensemble");
  }
  if (fields.Has("frames_per_action")) {
    adapter.frames_per_action = CountBetween(fields, "frames_per_action", 1, 1000);
  }
  return adapter;
}

}  // namespace physpring

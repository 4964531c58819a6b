// SPDX-License-Identifier: Apache-2.0
#include "cli/track_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "cli/warnings.h"
#include "jobs/tracking.h"
#include "tracker/live_tracker.h"
#include "twin/error.h"

namespace physpring {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 4> kKeys = {"points", "cloud", "controllers", "held"};
constexpr double kFar = 1000;  // m
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// [[x, y, z], null, ...] as 3 x any number; null: NaN.
Points PointsOf(const Json& frame, const char* key) {
  const auto found = frame.find(key);
  if (found == frame.end() || found->is_null()) return Points(3, 0);
  if (!found->is_array()) throw Error(fmt::format("'{}' is not a list of points", key));
  Points points(3, static_cast<Eigen::Index>(found->size()));
  for (std::size_t i = 0; i < found->size(); ++i) {
    const Json& point = (*found)[i];
    const bool is_point = point.is_array() && point.size() == 3 && point[0].is_number() &&
                          point[1].is_number() && point[2].is_number();
    if (!is_point && !point.is_null()) {
      throw Error(fmt::format("'{}' [{}] is not [x, y, z] or null", key, i));
    }
    for (int j = 0; j < 3; ++j) {
      const double coordinate = is_point ? point[j].get<double>() : kNan;
      if (std::abs(coordinate) > kFar) {
        throw Error(fmt::format("'{}' [{}] is {:.3g} m away, expected at most {} m", key, i,
                                std::abs(coordinate), kFar));
      }
      points(j, static_cast<Eigen::Index>(i)) = coordinate;
    }
  }
  return points;
}

// [true, false, ...]
std::optional<ControllerMask> HeldOf(const Json& frame) {
  const auto found = frame.find("held");
  if (found == frame.end() || found->is_null()) return {};
  const auto is_flag = [](const Json& one) { return one.is_boolean(); };
  if (!found->is_array() || !std::all_of(found->begin(), found->end(), is_flag)) {
    throw Error("'held' is not a list of true and false");
  }
  return found->get<ControllerMask>();
}

LiveFrame ParseFrame(const std::string& line) {
  const Json json = Json::parse(line, nullptr, false);
  if (!json.is_object()) throw Error("is not an object of JSON (which has null, not NaN)");
  for (const auto& item : json.items()) {
    if (std::find(kKeys.begin(), kKeys.end(), item.key()) == kKeys.end()) {
      throw Error(
          fmt::format("'{}' is not 'points', 'cloud', 'controllers' or 'held'", item.key()));
    }
  }
  return {{PointsOf(json, "points"), PointsOf(json, "cloud")},
          PointsOf(json, "controllers"),
          HeldOf(json)};
}

// To a micrometre, or a micrometre a second.
Json Rounded(const Points& points) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    Json point = Json::array();
    for (int j = 0; j < 3; ++j) point.push_back(std::round(1e6 * points(j, i)) / 1e6);
    list.push_back(std::move(point));
  }
  return list;
}

void PrintState(int frame, const StateTracker& state) {
  const Json json = {
      {"frame", frame},
      {"position", Rounded(state.position())},
      {"velocity", Rounded(state.velocity())},
      {"surprise", std::isfinite(state.surprise()) ? Json(state.surprise()) : Json(nullptr)}};
  fmt::print("{}\n", json.dump());
  std::fflush(stdout);
}

}  // namespace

void TrackStream(const std::string& twin_path, LiveOptions options) {
  const Twin twin = ReadTwin(twin_path);
  WarnOfTraining(twin, twin_path);
  if (options.fps == 0) options.fps = twin.fps;
  std::optional<LiveTracker> tracker;
  constexpr std::streamsize kLongest = 4 << 20;  // of a line
  std::vector<char> line(kLongest);
  for (int frame = 0; std::cin.getline(line.data(), kLongest) || std::cin.gcount() > 0; ++frame) {
    try {
      if (!std::cin) throw Error("is longer than 4 MiB");
      const LiveFrame measured = ParseFrame(line.data());
      if (tracker) {
        tracker->Advance(measured);
      } else {
        tracker.emplace(twin, options, measured);
        const std::string softened = WarningOfSoftened(tracker->softened());
        if (!softened.empty()) PrintWarnings({softened});
      }
    } catch (const Error& error) {
      throw Error(fmt::format("line {} of the input: {}", frame + 1, error.what()));
    }
    PrintState(frame, tracker->state());
  }
}

}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
#include "report/picture/film_data.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

namespace physpring {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostNumbers = 4'000'000;  // about 11 MB in base64
constexpr std::uint16_t kUnseen = 65535;

std::string Base64(const std::vector<std::uint16_t>& values) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<unsigned> bytes;  // little endian
  for (const unsigned value : values) bytes.insert(bytes.end(), {value & 255, value >> 8});
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
    const unsigned group =
        bytes[i] << 16 | (left > 1 ? bytes[i + 1] << 8 : 0) | (left > 2 ? bytes[i + 2] : 0);
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= left ? kDigits[group >> (18 - 6 * k) & 63] : '=';
    }
  }
  return text;
}

// Turns upright coordinates into steps from a corner. What is far outside is brought to the edge.
class Quantiser {
 public:
  explicit Quantiser(const View& view) : view_(view) {
    const Eigen::Vector3d size = view.high() - view.low();
    const double margin = 0.5 * size.norm() + 1e-6;
    corner_ = view.low().array() - margin;
    step_ = (size.maxCoeff() + 2 * margin) / (kUnseen - 1);
  }

  Json Corner() const { return {corner_.x(), corner_.y(), corner_.z()}; }
  double step() const { return step_; }

  std::string Encode(const std::vector<Points>& frames, int stride) const {
    std::vector<std::uint16_t> values;
    for (std::size_t t = 0; t < frames.size(); t += static_cast<std::size_t>(stride)) {
      AddUpright(view_.ToUpright(frames[t]), &values);
    }
    return Base64(values);
  }

  std::string EncodeUpright(const Points& upright) const {
    std::vector<std::uint16_t> values;
    AddUpright(upright, &values);
    return Base64(values);
  }

 private:
  void AddUpright(const Points& upright, std::vector<std::uint16_t>* values) const {
    for (Eigen::Index i = 0; i < upright.cols(); ++i) {
      for (int j = 0; j < 3; ++j) {
        const double steps = std::round((upright(j, i) - corner_[j]) / step_);
        values->push_back(std::isnan(steps)
                              ? kUnseen
                              : static_cast<std::uint16_t>(std::clamp(steps, 0.0, kUnseen - 1.0)));
      }
    }
  }

  const View& view_;
  Eigen::Vector3d corner_;
  double step_;
};

std::string EncodeSprings(const SpringMassSystem& system) {
  std::vector<std::uint16_t> ends;
  for (const auto& [a, b] : system.springs) {
    for (const int end : {a, b}) {
      ends.push_back(static_cast<std::uint16_t>(end & 65535));
      ends.push_back(static_cast<std::uint16_t>(end >> 16));
    }
  }
  return Base64(ends);
}

Json ToJson(const EvaluatedRecording& evaluated, const Twin& twin, const View& view, int stride) {
  const Recording& recording = evaluated.recording;
  const Quantiser quantiser(view);
  const Eigen::Vector3d extent = view.high() - view.low();
  Json levels = Json::array();
  for (const LevelResult& level : evaluated.result.levels) {
    Json json = {{"nodes", level.nodes},
                 {"springs", EncodeSprings(twin.levels[level.level].system)},
                 {"positions", quantiser.Encode(level.positions, stride)}};
    // at level 0 the points are the first nodes
    if (level.level > 0) json["points"] = quantiser.Encode(level.points, stride);
    levels.push_back(json);
  }
  return {{"name", recording.name},
          {"fps", recording.fps},
          {"frames", recording.frame_count()},
          {"stride", stride},
          {"split", evaluated.result.first_predicted},
          {"elevation", view.elevation()},
          {"corner", quantiser.Corner()},
          {"step", quantiser.step()},
          {"extent", {extent.x(), extent.y(), extent.z()}},
          {"size", extent.norm()},
          {"measured", quantiser.Encode(recording.points, stride)},
          {"controllers", quantiser.Encode(recording.controllers, stride)},
          {"ground", quantiser.EncodeUpright(GroundGrid(recording, view))},
          {"levels", levels}};
}

std::size_t NumbersOf(const EvaluatedRecording& evaluated) {
  Eigen::Index columns = evaluated.recording.point_count();
  for (const LevelResult& level : evaluated.result.levels) {
    columns += level.nodes + evaluated.recording.point_count();
  }
  return evaluated.recording.points.size() * static_cast<std::size_t>(3 * columns);
}

}  // namespace

std::string FormatFilmData(const Evaluation& evaluation, const std::vector<View>& views) {
  std::size_t numbers = 0;
  for (std::size_t i = 0; i < views.size(); ++i) numbers += NumbersOf(evaluation.recordings[i]);
  const int stride = static_cast<int>(numbers / kMostNumbers) + 1;
  Json json = Json::array();
  for (std::size_t i = 0; i < views.size(); ++i) {
    json.push_back(ToJson(evaluation.recordings[i], evaluation.twin, views[i], stride));
  }
  // "</script>" in a name would end the script
  std::string text = json.dump(-1, ' ', true, Json::error_handler_t::replace);
  for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos;) {
    text.replace(at, 1, "\\u003c");
  }
  return text;
}

}  // namespace physpring

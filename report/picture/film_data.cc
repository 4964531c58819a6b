// SPDX-License-Identifier: Apache-2.0
#include "report/picture/film_data.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "report/picture/base64.h"

namespace physpring {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostNumbers = 4'000'000;  // about 11 MB in base64
constexpr std::uint16_t kUnseen = 65535;

std::string Encoded(const std::vector<std::uint16_t>& values) {
  std::string bytes;  // little endian
  for (const unsigned value : values) {
    bytes += static_cast<char>(value & 255);
    bytes += static_cast<char>(value >> 8);
  }
  return Base64(bytes);
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
    return Encoded(values);
  }

  std::string EncodeUpright(const Points& upright) const {
    std::vector<std::uint16_t> values;
    AddUpright(upright, &values);
    return Encoded(values);
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
  return Encoded(ends);
}

Json ToJson(const FilmLayer& layer, const Quantiser& quantiser, int stride) {
  Json json = {{"nodes", layer.system->node_count()},
               {"springs", EncodeSprings(*layer.system)},
               {"positions", quantiser.Encode(*layer.nodes, stride)}};
  if (layer.points) json["points"] = quantiser.Encode(*layer.points, stride);
  return json;
}

Json ToJson(const FilmMark& mark, const View& view, const Quantiser& quantiser) {
  Json json = {{"layer", mark.layer}, {"node", mark.node}};
  if (mark.anchor) json["anchor"] = quantiser.EncodeUpright(view.ToUpright(*mark.anchor));
  return json;
}

Json ToJson(const FilmRecording& film, const View& view, int stride) {
  const Recording& recording = *film.recording;
  const Quantiser quantiser(view);
  const Eigen::Vector3d extent = view.high() - view.low();
  Json layers = Json::array(), spans = Json::array(), marks = Json::array();
  for (const FilmLayer& layer : film.layers) layers.push_back(ToJson(layer, quantiser, stride));
  for (const FilmSpan& span : film.spans) spans.push_back({span.first, span.name, span.fitted});
  for (const FilmMark& mark : film.marks) marks.push_back(ToJson(mark, view, quantiser));
  return {{"name", recording.name},
          {"fps", recording.fps},
          {"frames", recording.frame_count()},
          {"stride", stride},
          {"begin", film.begin},
          {"spans", spans},
          {"elevation", view.elevation()},
          {"corner", quantiser.Corner()},
          {"step", quantiser.step()},
          {"extent", {extent.x(), extent.y(), extent.z()}},
          {"size", extent.norm()},
          {"measured", quantiser.Encode(recording.points, stride)},
          {"controllers", quantiser.Encode(recording.controllers, stride)},
          {"ground", quantiser.EncodeUpright(GroundGrid(recording, view))},
          {"layers", layers},
          {"marks", marks}};
}

std::size_t NumbersOf(const FilmRecording& film) {
  const int points = film.recording->point_count();
  Eigen::Index columns = points;
  for (const FilmLayer& layer : film.layers) columns += layer.system->node_count() + points;
  return film.recording->points.size() * static_cast<std::size_t>(3 * columns);
}

}  // namespace

std::string FormatFilmData(const std::vector<FilmRecording>& recordings,
                           const std::vector<View>& views) {
  std::size_t numbers = 0;
  for (const FilmRecording& film : recordings) numbers += NumbersOf(film);
  const int stride = static_cast<int>(numbers / kMostNumbers) + 1;
  Json json = Json::array();
  for (std::size_t i = 0; i < views.size(); ++i) {
    json.push_back(ToJson(recordings[i], views[i], stride));
  }
  // "</script>" in a name would end the script
  std::string text = json.dump(-1, ' ', true, Json::error_handler_t::replace);
  for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos;) {
    text.replace(at, 1, "\\u003c");
  }
  return text;
}

}  // namespace physpring

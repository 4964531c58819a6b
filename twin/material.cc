// SPDX-License-Identifier: Apache-2.0
#include "twin/material.h"

#include <string>

namespace physpring {
namespace {

using Json = nlohmann::ordered_json;

// Numbers of one key, of which there must be so many.
std::vector<double> Numbers(const JsonFields& fields, const std::string& key, std::size_t count) {
  std::vector<double> numbers = fields.Numbers(key);
  if (numbers.size() != count) {
    fields.Fail(key, "holds " + std::to_string(numbers.size()) + " numbers, expected " +
                         std::to_string(count));
  }
  return numbers;
}

Json ToJson(const Estimate& estimate) { return {estimate.value, estimate.low, estimate.high}; }

Estimate ReadEstimate(const JsonFields& fields, const std::string& key) {
  const std::vector<double> numbers = Numbers(fields, key, 3);
  const Estimate estimate{numbers[0], numbers[1], numbers[2]};
  if (estimate.low < 0 || estimate.value < estimate.low || estimate.high < estimate.value) {
    fields.Fail(key, "is not a value, its lower and its upper bound, all from 0");
  }
  return estimate;
}

Json ToJson(const Material::Place& place) {
  return {{"position_m", {place.position[0], place.position[1], place.position[2]}},
          {"factor", ToJson(place.factor)}};
}

Material::Place ReadPlace(const JsonFields& fields) {
  fields.ExpectOnly({"position_m", "factor"});
  const std::vector<double> position = Numbers(fields, "position_m", 3);
  return {{position[0], position[1], position[2]}, ReadEstimate(fields, "factor")};
}

}  // namespace

nlohmann::ordered_json MaterialToJson(const Material& material) {
  Json classes = Json::array();
  for (const Material::LengthClass& one : material.classes) {
    classes.push_back({{"shortest_m", one.shortest},
                       {"longest_m", one.longest},
                       {"springs", one.springs},
                       {"axial_stiffness_n", ToJson(one.axial_stiffness)}});
  }
  return {{"classes", classes},
          {"loss_time_s", ToJson(material.loss_time)},
          {"drag_1_s", ToJson(material.drag)},
          {"softest", ToJson(material.softest)},
          {"stiffest", ToJson(material.stiffest)}};
}

Material MaterialFromJson(const JsonFields& fields) {
  fields.ExpectOnly({"classes", "loss_time_s", "drag_1_s", "softest", "stiffest"});
  Material material;
  for (const JsonFields& one : fields.Objects("classes")) {
    one.ExpectOnly({"shortest_m", "longest_m", "springs", "axial_stiffness_n"});
    material.classes.push_back({one.Number("shortest_m"), one.Number("longest_m"),
                                one.Count("springs"), ReadEstimate(one, "axial_stiffness_n")});
  }
  material.loss_time = ReadEstimate(fields, "loss_time_s");
  material.drag = ReadEstimate(fields, "drag_1_s");
  material.softest = ReadPlace(fields.Object("softest"));
  material.stiffest = ReadPlace(fields.Object("stiffest"));
  return material;
}

}  // namespace physpring

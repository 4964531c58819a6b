// SPDX-License-Identifier: Apache-2.0
#include "rollout/scene_spec.h"

#include <array>

#include "rollout/mujoco_log.h"
#include "twin/atomic_file.h"
#include "twin/error.h"

namespace physpring {
namespace {

// `parse`: (message, its size) -> mjSpec*.
template <class Parse>
SpecPtr ParseWith(const std::string& where, std::vector<std::string>* warnings, Parse parse) {
  std::array<char, 1024> message{};
  mjSpec* spec = nullptr;
  CatchMujoco(
      where, [&] { spec = parse(message.data(), static_cast<int>(message.size())); }, warnings);
  if (!spec) throw Error(where + ": " + OneLine(message.data()));
  return SpecPtr(spec);
}

}  // namespace

SpecPtr ParseSpec(const std::string& path, std::vector<std::string>* warnings) {
  ExpectRegularFile(path);
  return ParseWith(path, warnings, [&](char* message, int size) {
    return mj_parseXML(path.c_str(), nullptr, message, size);
  });
}

SpecPtr ParseSpecText(const std::string& mjcf, const std::string& where,
                      std::vector<std::string>* warnings) {
  return ParseWith(where, warnings, [&](char* message, int size) {
    return mj_parseXMLString(mjcf.c_str(), nullptr, message, size);
  });
}

}  // namespace physpring

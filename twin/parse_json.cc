// SPDX-License-Identifier: Apache-2.0
#include "twin/parse_json.h"

#include <fmt/format.h>

#include "twin/error.h"

namespace physpring {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kDeepest = 32;

}  // namespace

Json ParseJson(const std::string& text, const std::string& where) {
  const auto check_depth = [&](int depth, Json::parse_event_t, Json&) {
    if (depth <= kDeepest) return true;
    throw Error(fmt::format("{}: is nested more than {} deep", where, kDeepest));
  };
  try {
    return Json::parse(text, check_depth);
  } catch (const Json::parse_error& error) {
    throw Error(fmt::format("{}: is not JSON, byte {} is unexpected", where, error.byte));
  } catch (const Json::out_of_range&) {
    throw Error(fmt::format("{}: has a number that is too large", where));
  }
}

}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
// JSON that is too much of something is refused at once, whatever comes behind it.
#include "twin/json_text.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>

#include "tests/support/file_damage.h"
#include "twin/effects/effect_json.h"

namespace physpring {
namespace {

std::string Repeat(const std::string& text, int count) {
  std::string repeated;
  for (int i = 0; i < count; ++i) repeated += text;
  return repeated;
}

std::string Nested(int depth) { return Repeat("[", depth) + Repeat("]", depth); }

std::string Keys(int count) {
  std::string object = "{";
  for (int i = 0; i < count; ++i) object += fmt::format("{}\"{}\":0", i == 0 ? "" : ",", i);
  return object + "}";
}

std::string ErrorOfText(const std::string& text) {
  return ErrorOf("file", [&] { ParseJson(text, "file"); });
}

TEST(JsonText, KeepsKeysInTheirOrder) {
  EXPECT_EQ(ParseJson(R"({"b": [1, {"a": null}], "a": 2.5})", "file").dump(),
            R"({"b":[1,{"a":null}],"a":2.5})");
}

TEST(JsonText, NamesTheByteThatIsWrong) {
  EXPECT_EQ(ErrorOfText("[1, x]"), "file: is not JSON, byte 5 is unexpected");
  EXPECT_EQ(ErrorOfText("[1e999]"), "file: has a number that is too large");
}

TEST(JsonText, AKeyIsInAnObjectOnce) {
  EXPECT_EQ(ErrorOfText(R"([{"a": 1, "b": {"a": 2}, "a": 3}])"), "file: has key 'a' twice");
  EXPECT_NO_THROW(ParseJson(R"({"a": [{"b": 1}, {"b": 2}], "c": {"a": 3}})", "file"));
}

TEST(JsonText, DepthIsLimited) {
  EXPECT_NO_THROW(ParseJson(Nested(JsonLimits::kDepth), "file"));
  EXPECT_EQ(ErrorOfText(Nested(JsonLimits::kDepth + 1)), "file: is nested more than 32 deep");
  EXPECT_EQ(ErrorOfText(Nested(1000000)), "file: is nested more than 32 deep");
  EXPECT_EQ(ErrorOfText(Repeat(R"({"a":)", 100000)), "file: is nested more than 32 deep");
}

TEST(JsonText, ValuesAreCounted) {
  const int most = JsonLimits::kValues - 1;  // the array is one itself
  EXPECT_EQ(ParseJson("[" + Repeat("0,", most - 1) + "0]", "file").size(), most);
  EXPECT_EQ(ErrorOfText("[" + Repeat("0,", most) + "0]"), "file: has more than 262144 values");
  EXPECT_EQ(ErrorOfText("[" + Repeat("[],", most) + "0]"), "file: has more than 262144 values");
}

// Each object once took as long as all before it: half a minute in all.
TEST(JsonText, ManyObjectsTakeNoLongerThanManyLists) {
  const auto begun = std::chrono::steady_clock::now();
  const std::string objects = "[" + Repeat("{},", JsonLimits::kValues - 2) + "{}]";
  EXPECT_EQ(ParseJson(objects, "file").size(), JsonLimits::kValues - 1);
  EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(5));
}

TEST(JsonText, KeysAreCountedInEachObject) {
  const std::string full = Keys(JsonLimits::kKeys);
  EXPECT_NO_THROW(ParseJson("[" + full + "," + full + R"(, {"a":)" + full + "}]", "file"));
  EXPECT_EQ(ErrorOfText(R"({"a":)" + Keys(JsonLimits::kKeys + 1) + "}"),
            "file: has an object of more than 1000 keys");
}

TEST(JsonText, LengthIsLimited) {
  EXPECT_EQ(ErrorOfText(std::string(JsonLimits::kBytes + 1, ' ')),
            "file: has 4194305 bytes of JSON, expected at most 4194304");
}

TEST(EffectJson, QuotesLittleOfWhatItRefuses) {
  const auto error = [](const std::string& text) {
    return ErrorOf("twin", [&] { EffectsFromJson(text, "twin"); });
  };
  EXPECT_EQ(error(Nested(100000)), "twin: is nested more than 32 deep");
  EXPECT_EQ(error("{}"), "twin: is not a JSON list of effects");
  EXPECT_EQ(
      error("[\"" + std::string(1000, 'x') + "\"]"),
      "twin: holds '\"" + std::string(59, 'x') + "...', expected an object of name and parameters");
  EXPECT_EQ(error(R"([{"name": "a\nb)" + std::string(1000, 'x') + R"(", "parameters": {}}])"),
            "twin: there is no effect 'a?b" + std::string(57, 'x') + "...'");
  EXPECT_EQ(error(R"([{"name": "tension_only", "parameters": {"slack_share": ")" +
                  std::string(1000, 'x') + R"("}}])"),
            "twin: slack_share of effect tension_only is '\"" + std::string(59, 'x') +
                "...', expected a number");
}

}  // namespace
}  // namespace physpring

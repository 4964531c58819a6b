// SPDX-License-Identifier: Apache-2.0
#include "jobs/train_options_json.h"

#include <gtest/gtest.h>

#include "twin/error.h"

namespace physpring {
namespace {

TEST(TrainOptionsJson, IsReadBack) {
  for (const char* json :
       {R"({"method": "smooth", "levels": 3, "ratios": [0.5, 0.25], "reduction": "kmeans"})",
        R"({"neighbours": [8, 20], "epochs": 7, "substeps": 40, "precision": "float"})",
        R"({"controller_velocity": "off", "cone": "pyramidal", "network_epochs": 4, "levels": 2})",
        R"({"method": "two-stage", "self_collision": "on", "epochs": "auto"})", "{}"}) {
    const TrainOptions options = ParseTrainOptions(json);
    const std::string text = TrainOptionsJson(options, "");
    EXPECT_EQ(TrainOptionsJson(ParseTrainOptions(text), ""), text);
  }
  const TrainOptions options = ParseTrainOptions(R"({"neighbours": 6, "self_collision": true})");
  EXPECT_EQ(options.neighbours, std::vector<int>{6});
  EXPECT_TRUE(options.self_collision);
}

TEST(ParseTrainOptions, SaysWhatIsWrong) {
  const auto message = [](const char* json) -> std::string {
    try {
      ParseTrainOptions(json);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message(R"({"levels": 11})"),
            "training option levels is 11, expected a whole number from 1 to 10");
  EXPECT_EQ(message(R"({"levels": 1.5})"),
            "training option levels is 1.5, expected a whole number from 1 to 10");
  EXPECT_EQ(message(R"({"method": "fast"})"),
            "training option method is \"fast\", expected one of full, smooth, two-stage");
  EXPECT_EQ(message(R"({"ratios": [2]})"),
            "training option ratios is 2, expected numbers from 0 to 1");
  EXPECT_EQ(message(R"({"neighbours": []})"),
            "training option neighbours is [], expected a list of numbers");
  EXPECT_TRUE(message(R"({"level": 2})").starts_with("training option 'level' is unknown"));
}

TEST(CheckTrainOptions, NamesTheOption) {
  const auto option = [](const char* json, const TrainSources& sources = {}) {
    const auto error = CheckTrainOptions(ParseTrainOptions(json), sources);
    return error ? error->option : "";
  };
  EXPECT_EQ(option("{}"), "");
  EXPECT_EQ(option(R"({"levels": 5})"), "ratios");
  EXPECT_EQ(option(R"({"reduction": "kmeans"})"), "reduction");
  EXPECT_EQ(option(R"({"method": "two-stage", "neighbours": 8})"), "neighbours");
  EXPECT_EQ(option("{}", {.from = true, .effects = true}), "effects");
}

}  // namespace
}  // namespace physpring

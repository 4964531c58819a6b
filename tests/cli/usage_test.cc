// SPDX-License-Identifier: Apache-2.0
// The help of `physpring` and its lines about bad usage.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/program.h"

namespace physpring {
namespace {

const char* const kCommands[] = {"record", "train", "eval", "info", "doctor"};

TEST(Usage, HelpIsInPlainWords) {
  for (const char* command : kCommands) {
    const ProgramResult result = RunProgram({command, "--help"});
    EXPECT_EQ(result.status, 0);
    EXPECT_NE(result.output.find(std::string("Usage: physpring ") + command), std::string::npos);
    for (const char* code : {"{", "->", " in [", "INT", "FLOAT", "TEXT", "POSITIVE", ":="}) {
      EXPECT_EQ(result.output.find(code), std::string::npos) << code << " in " << result.output;
    }
  }
}

TEST(Usage, HelpNamesWhatAnOptionTakes) {
  const std::string train = RunProgram({"train", "--help"}).output;
  for (const char* option :
       {"--method full|smooth|two-stage", "--neighbours N[,N...]|auto", "--checkpoint SECONDS"}) {
    EXPECT_NE(train.find(option), std::string::npos) << option << " in " << train;
  }
  EXPECT_NE(RunProgram({"record", "--help"}).output.find("--noise METRES"), std::string::npos);
  EXPECT_NE(RunProgram({"record", "--help"}).output.find("tether.stiffness_n_per_m  "),
            std::string::npos);
}

// Status 2, nothing on standard output, and this line on standard error.
void ExpectRefused(const std::vector<std::string>& words, const std::string& line) {
  const ProgramResult result = RunProgram(words);
  EXPECT_EQ(result.status, 2) << line;
  EXPECT_EQ(result.output, "");
  EXPECT_EQ(result.errors, line + "\n");
}

TEST(Usage, BadUsageIsOneLine) {
  ExpectRefused({"record", "a.xml", "-o", "a.npz", "--noise", "nan"},
                "physpring record: --noise: takes a number from 0 to 1, not 'nan' (see physpring "
                "record --help)");
  ExpectRefused({"record", "a.xml", "-o", "a.npz", "--duration", "-1"},
                "physpring record: --duration: takes a number from 1e-06 to 1000000, not '-1' (see "
                "physpring record --help)");
  const auto effect = [](const std::string& value, const std::string& message) {
    ExpectRefused({"record", "a.xml", "-o", "a.npz", "--effect", value},
                  "physpring record: --effect: " + message + " (see physpring record --help)");
  };
  effect("yield.yield_strain=a lot", "yield.yield_strain takes a number from 0 to 10, not 'a lot'");
  effect("tether.anchor_x_m", "tether.anchor_x_m takes a number from -100 to 100, not ''");
  ExpectRefused({"record", "a.xml", "-o", "a.npz", "--effect", "yield.yield_strain=1", "--effect",
                 "yield.yield_strain=2"},
                "physpring record: --effect: yield.yield_strain is given twice (see physpring "
                "record --help)");
  const ProgramResult unknown =
      RunProgram({"record", "a.xml", "-o", "a.npz", "--effect", "wind=3"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.errors.find("there is no effect 'wind', but air_drag.wind_x_m_per_s, "),
            std::string::npos)
      << unknown.errors;
  ExpectRefused({"eval", "a.npz", "b.npz", "--substeps", "few"},
                "physpring eval: --substeps: takes a whole number from 1 to 1000000, or auto, not "
                "'few' (see physpring eval --help)");
  ExpectRefused({"eval", "a.npz", "b.npz", "--precision", "half"},
                "physpring eval: --precision: takes double or float, not 'half' (see physpring "
                "eval --help)");
  ExpectRefused({"trian"}, "physpring: unknown command trian (see physpring --help)");
  ExpectRefused({"export", "a.npz", "-o", ""},
                "physpring export: --output: takes a name, not '' (see physpring export --help)");
  ExpectRefused({"info"}, "physpring info: file is required (see physpring info --help)");
  const ProgramResult nothing = RunProgram({});
  EXPECT_EQ(nothing.status, 2);
  EXPECT_EQ(std::count(nothing.errors.begin(), nothing.errors.end(), '\n'), 1) << nothing.errors;
}

TEST(Usage, ACountEndsBeforeTheFilesThatFollow) {
  const ProgramResult result =
      RunProgram({"train", "--neighbours", "8", "none.npz", "-o", "a.npz"});
  EXPECT_TRUE(FailsWith(result, "none.npz: does not exist")) << result.errors;
}

}  // namespace
}  // namespace physpring

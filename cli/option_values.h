// SPDX-License-Identifier: Apache-2.0
// What the values of options may be. Each function gives a check for CLI::Option. Its message says
// in plain words what would be right. It adds nothing to the help (CLI11's own checks show their
// code there).
#ifndef PHYSPRING_CLI_OPTION_VALUES_H_
#define PHYSPRING_CLI_OPTION_VALUES_H_

#include <CLI/CLI.hpp>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "jobs/word.h"

namespace physpring {

// A finite number from `least` to `most`.
CLI::Validator NumberBetween(double least, double most);

// A whole number from `least` to `most`.
CLI::Validator WholeNumberBetween(std::int64_t least, std::int64_t most);

// A whole number from 1 to `most`, or `auto`, which becomes 0: for CLI::Option::transform.
CLI::Validator WholeNumberOrAuto(std::int64_t most);

// Any text but the empty one.
CLI::Validator NotEmpty();

// A name that ends with `ending`, ".npz".
CLI::Validator FileNameWith(const std::string& ending);

// One of a few words.
CLI::Validator OneOf(const std::vector<std::string>& words);

// Adds --seed, which takes any whole number that a seed can be.
CLI::Option* AddSeed(CLI::App* command, std::uint64_t* seed, const std::string& description);

// Adds an option that takes one of `words` and sets `value` to what the word stands for. The help
// lists the words: "full|two-stage". They must outlive the command.
template <class Value, std::size_t kCount>
CLI::Option* AddChoice(CLI::App* command, const std::string& name, Value* value,
                       const Word<Value> (&words)[kCount], const std::string& description) {
  std::vector<std::string> choices;
  for (const auto& [word, meaning] : words) choices.emplace_back(word);
  const auto set = [value, &words](const std::string& choice) {
    for (const auto& [word, meaning] : words) {
      if (word == choice) *value = meaning;
    }
  };
  return command->add_option_function<std::string>(name, set, description)
      ->check(OneOf(choices))
      ->type_name(CLI::detail::join(choices, "|"))
      ->default_str(WordOf(words, *value));
}

// Adds --precision, the precision of the simulation: double or float.
CLI::Option* AddPrecision(CLI::App* command, bool* single);

// Adds an option that takes a whole number from 1, or `auto`, which sets `number` to 0.
CLI::Option* AddNumberOrAuto(CLI::App* command, const std::string& name, int* number,
                             const std::string& description);

// As many threads as the machine runs at once.
int AllCores();

// Adds --threads, the most threads that a command may use.
CLI::Option* AddThreads(CLI::App* command, int* threads, const std::string& description);

}  // namespace physpring

#endif  // PHYSPRING_CLI_OPTION_VALUES_H_

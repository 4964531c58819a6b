// SPDX-License-Identifier: Apache-2.0
#include "cli/option_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>
#include <thread>

#include "twin/quote.h"

namespace physpring {
namespace {

// The number that the whole text is.
template <class Number>
std::optional<Number> Parse(const std::string& text) {
  Number number{};
  const char* const end = text.data() + text.size();
  const auto [rest, failure] = std::from_chars(text.data(), end, number);
  if (failure != std::errc() || rest != end) return std::nullopt;
  return number;
}

template <class Number>
bool IsBetween(const std::string& text, Number least, Number most) {
  const std::optional<Number> number = Parse<Number>(text);
  return number && *number >= least && *number <= most;  // NaN is not
}

// An empty message means that the value is right.
std::string Expect(bool right, const std::string& what, const std::string& text) {
  return right ? "" : fmt::format("takes {}, not {}", what, Quote(text));
}

}  // namespace

CLI::Validator NumberBetween(double least, double most) {
  return {[=](std::string& text) {
            return Expect(IsBetween(text, least, most),
                          fmt::format("a number from {} to {}", least, most), text);
          },
          ""};
}

CLI::Validator WholeNumberBetween(std::int64_t least, std::int64_t most) {
  return {[=](std::string& text) {
            return Expect(IsBetween(text, least, most),
                          fmt::format("a whole number from {} to {}", least, most), text);
          },
          ""};
}

CLI::Validator WholeNumberOrAuto(std::int64_t most) {
  return {[=](std::string& text) {
            const bool automatic = text == "auto";
            if (automatic) text = "0";
            return Expect(automatic || IsBetween<std::int64_t>(text, 1, most),
                          fmt::format("a whole number from 1 to {}, or auto", most), text);
          },
          ""};
}

CLI::Validator NotEmpty() {
  return {[](std::string& text) { return Expect(!text.empty(), "a name", text); }, ""};
}

CLI::Validator FileNameWith(const std::string& ending) {
  return {[=](std::string& text) {
            return Expect(text.size() > ending.size() && text.ends_with(ending),
                          fmt::format("a file name that ends with {}", ending), text);
          },
          ""};
}

CLI::Validator OneOf(const std::vector<std::string>& words) {
  return {[=](std::string& text) {
            return Expect(std::find(words.begin(), words.end(), text) != words.end(),
                          fmt::format("{}", fmt::join(words, " or ")), text);
          },
          ""};
}

CLI::Option* AddSeed(CLI::App* command, std::uint64_t* seed, const std::string& description) {
  const auto is_seed = [](std::string& text) {
    constexpr std::uint64_t kLargest = std::numeric_limits<std::uint64_t>::max();
    return Expect(Parse<std::uint64_t>(text).has_value(),
                  fmt::format("a whole number from 0 to {}", kLargest), text);
  };
  return command->add_option("--seed", *seed, description)
      ->check(CLI::Validator(is_seed, ""))
      ->type_name("N")
      ->capture_default_str();
}

CLI::Option* AddPrecision(CLI::App* command, bool* single) {
  return AddChoice(command, "--precision", single, kPrecisionWords, "of the simulation");
}

CLI::Option* AddNumberOrAuto(CLI::App* command, const std::string& name, int* number,
                             const std::string& description) {
  return command->add_option(name, *number, description)
      ->transform(WholeNumberOrAuto(1000000))
      ->type_name("N|auto")
      ->default_str("auto");
}

int AllCores() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

CLI::Option* AddThreads(CLI::App* command, int* threads, const std::string& description) {
  return command->add_option("--threads", *threads, description)
      ->check(WholeNumberBetween(1, 1024))
      ->type_name("N")
      ->capture_default_str();
}

}  // namespace physpring

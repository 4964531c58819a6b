// SPDX-License-Identifier: Apache-2.0
#include "cli/train_flags.h"

#include "cli/option_values.h"
#include "jobs/train_option_list.h"
#include "trainer/reduction/registry.h"

namespace physpring {
namespace {

class FlagVisitor {
 public:
  explicit FlagVisitor(CLI::App* command) : command_(command) {}

  static bool all() { return true; }

  template <class Value, std::size_t kCount>
  void Choice(const char* name, Value* value, const Word<Value> (&words)[kCount],
              const char* help) const {
    AddChoice(command_, FlagOf(name), value, words, help);
  }
  void Reduction(const char* name, std::string* reduction, const std::string& help) const {
    std::vector<std::string> names;
    std::string each;
    for (const auto& one : AllReductions()) {
      names.push_back(one->name());
      each += "; " + one->name() + ": " + one->help();
    }
    command_->add_option(FlagOf(name), *reduction, help + each)
        ->check(OneOf(names))
        ->type_name(CLI::detail::join(names, "|"))
        ->capture_default_str();
  }
  void Count(const char* name, int* count, int least, int most, const char* help) const {
    command_->add_option(FlagOf(name), *count, help)
        ->check(WholeNumberBetween(least, most))
        ->type_name("N")
        ->capture_default_str();
  }
  void CountOrAuto(const char* name, int* count, const char* help) const {
    AddNumberOrAuto(command_, FlagOf(name), count, help);
  }
  void Flag(const char* name, bool* value, const char* help) const {
    command_->add_flag(FlagOf(name), *value, help);
  }
  void Ratios(const char* name, std::vector<double>* ratios, int /*levels*/,
              const char* help) const {
    command_->add_option(FlagOf(name), *ratios, help)
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(NumberBetween(0, 1))
        ->type_name("R[,R...]")
        ->default_str("0.6,0.4,0.3");
  }
  void Neighbours(const char* name, std::vector<int>* counts, const char* help) const {
    command_->add_option(FlagOf(name), *counts, help)
        ->delimiter(',')
        ->allow_extra_args(false)
        ->transform(WholeNumberOrAuto(1000))
        ->type_name("N[,N...]|auto")
        ->default_str("auto");
  }

 private:
  static std::string FlagOf(const char* name) { return std::string("--") + name; }

  CLI::App* command_;
};

}  // namespace

void AddTrainFlags(CLI::App* command, TrainOptions* options) {
  FlagVisitor visitor(command);
  VisitTrainOptions(*options, visitor);
}

}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
#include "cli/train_options.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/option_values.h"
#include "cli/train_words.h"
#include "trainer/reduction/registry.h"
#include "twin/effects/effect_json.h"
#include "twin/json_text.h"

namespace physpring {
namespace {

using Json = nlohmann::ordered_json;

// The options of coarse levels. A visitor is told of each flag, its value, what it may be, and the
// help.
template <class Options, class Visitor>
void VisitHierarchyOptions(Options& options, Visitor& visit) {
  visit.Ratios("--ratios", &options.ratios, options.levels,
               "nodes of levels 1, 2, ... as parts of level 0's particles");
  visit.Reduction("--reduction", &options.reduction, "which nodes become one coarser one");
  auto& network = options.network;
  visit.Choice("--features", &network.features, kFeatureWords,
               "of nodes, by which a reduction that learns joins them: the network's, those of a "
               "network that does not learn, or positions at rest");
  visit.Count("--network-epochs", &network.epochs, 0, 10000, "of each level; 0: no corrections");
  visit.Count("--network-updates", &network.updates, 1, 1000,
              "of the network in an epoch (K_model)");
  visit.Count("--contact-updates", &network.contact_updates, 0, 1000,
              "of the ground's contact alone after each epoch (K_col)");
  visit.Count("--latent", &network.latent, 2, 1024, "features of a node in the network");
}

template <class Options, class Visitor>
void VisitFitOptions(Options& options, Visitor& visit) {
  visit.Neighbours(
      "--neighbours", &options.neighbours,
      "springs of a particle; of several the best on held-back frames (not two-stage)");
  visit.Choice("--optimizer", &options.optimizer, kOptimizerWords, "of single springs (full)");
  visit.CountOrAuto("--epochs", &options.epochs, "steps of the last stage");
  visit.CountOrAuto("--substeps", &options.substeps,
                    "sub-steps of a frame; auto: as many as are stable");
  visit.Choice("--precision", &options.single_precision, kPrecisionWords, "of the simulation");
  visit.Choice("--controller-velocity", &options.controller_velocity, kVelocityWords,
               "whether dashpots feel the controllers' velocity; auto: what leaves less in a fit, "
               "no (two-stage)");
  visit.Choice("--cone", &options.cone, kConeWords,
               "of friction on the ground: Coulomb's, or MuJoCo's default; auto: whatever predicts "
               "better, elliptic (two-stage)");
  visit.Flag("--self-collision", &options.self_collision,
             "let particles collide with each other (two-stage)");
}

// All options. The coarse levels' are left out of a twin that has none.
template <class Options, class Visitor>
void VisitTrainOptions(Options& options, Visitor& visit) {
  visit.Choice("--method", &options.method, kMethodWords,
               "full: a smooth body of few numbers, or single springs where they predict better; "
               "smooth: the smooth body; two-stage: as PhysTwin does");
  visit.Count("--levels", &options.levels, 1, 10, "levels of the twin, level 0 included");
  if (visit.all() || options.levels > 1) VisitHierarchyOptions(options, visit);
  VisitFitOptions(options, visit);
}

class FlagVisitor {
 public:
  explicit FlagVisitor(CLI::App* command) : command_(command) {}

  static bool all() { return true; }

  template <class Value, std::size_t kCount>
  void Choice(const char* flag, Value* value, const Word<Value> (&words)[kCount],
              const char* help) const {
    AddChoice(command_, flag, value, words, help);
  }
  void Reduction(const char* flag, std::string* name, const std::string& help) const {
    std::vector<std::string> names;
    std::string each;
    for (const auto& reduction : AllReductions()) {
      names.push_back(reduction->name());
      each += "; " + reduction->name() + ": " + reduction->help();
    }
    command_->add_option(flag, *name, help + each)
        ->check(OneOf(names))
        ->type_name(CLI::detail::join(names, "|"))
        ->capture_default_str();
  }
  void Count(const char* flag, int* count, int least, int most, const char* help) const {
    command_->add_option(flag, *count, help)
        ->check(WholeNumberBetween(least, most))
        ->type_name("N")
        ->capture_default_str();
  }
  void CountOrAuto(const char* flag, int* count, const char* help) const {
    AddNumberOrAuto(command_, flag, count, help);
  }
  void Flag(const char* flag, bool* value, const char* help) const {
    command_->add_flag(flag, *value, help);
  }
  void Ratios(const char* flag, std::vector<double>* ratios, int /*levels*/,
              const char* help) const {
    command_->add_option(flag, *ratios, help)
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(NumberBetween(0, 1))
        ->type_name("R[,R...]")
        ->default_str("0.6,0.4,0.3");
  }
  void Neighbours(const char* flag, std::vector<int>* counts, const char* help) const {
    command_->add_option(flag, *counts, help)
        ->delimiter(',')
        ->allow_extra_args(false)
        ->transform(WholeNumberOrAuto(1000))
        ->type_name("N[,N...]|auto")
        ->default_str("auto");
  }

 private:
  CLI::App* command_;
};

class JsonVisitor {
 public:
  static bool all() { return false; }

  template <class Value, std::size_t kCount>
  void Choice(const char* flag, const Value* value, const Word<Value> (&words)[kCount],
              const char* /*help*/) {
    (*this)[flag] = WordOf(words, *value);
  }
  void Reduction(const char* flag, const std::string* name, const char* /*help*/) {
    (*this)[flag] = *name;
  }
  void Count(const char* flag, const int* count, int /*least*/, int /*most*/,
             const char* /*help*/) {
    (*this)[flag] = *count;
  }
  void CountOrAuto(const char* flag, const int* count, const char* /*help*/) {
    (*this)[flag] = *count > 0 ? Json(*count) : Json("auto");
  }
  void Flag(const char* flag, const bool* value, const char* /*help*/) {
    (*this)[flag] = *value ? "on" : "off";
  }
  void Ratios(const char* flag, const std::vector<double>* ratios, int levels,
              const char* /*help*/) {
    (*this)[flag] = std::vector<double>(ratios->begin(), ratios->begin() + levels - 1);
  }
  void Neighbours(const char* flag, const std::vector<int>* counts, const char* /*help*/) {
    (*this)[flag] = counts->empty() ? Json("auto") : Json(*counts);
  }

  // "--network-epochs" is network_epochs.
  Json& operator[](const std::string& flag) {
    std::string key = flag.substr(flag.find_first_not_of('-'));
    std::replace(key.begin(), key.end(), '-', '_');
    return json[key];
  }

  Json json;
};

}  // namespace

void AddTrainFlags(CLI::App* command, TrainOptions* options) {
  FlagVisitor visitor(command);
  VisitTrainOptions(*options, visitor);
}

std::string TrainOptionsJson(const TrainOptions& options, const std::string& from) {
  JsonVisitor visitor;
  VisitTrainOptions(options, visitor);
  Json& json = visitor.json;
  if (!from.empty()) json["from"] = from;
  if (!options.effects.empty())
    json["effects"] = ParseJson(EffectsToJson(options.effects), "--effects");
  return json.dump();
}

}  // namespace physpring

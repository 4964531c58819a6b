// SPDX-License-Identifier: Apache-2.0
#include "plugin/attributes.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string_view>

#include "twin/error.h"
#include "twin/quote.h"

namespace physpring {
namespace {

constexpr std::string_view kSpace = " \t\r\n";

bool IsFinite(double value) { return std::isfinite(value); }
bool IsFinite(int) { return true; }

}  // namespace

Attributes::Attributes(const mjModel* model, int instance) : model_(model), instance_(instance) {
  const char* name = mj_id2name(model, mjOBJ_PLUGIN, instance);
  const mjpPlugin* plugin = mjp_getPluginAtSlot(model->plugin[instance]);
  where_ = plugin->name;
  if (name != nullptr && *name != '\0') where_.append(" ").append(Quote(name));
}

void Attributes::Fail(const char* name, const std::string& problem) const {
  throw Error(fmt::format("{}: attribute '{}' {}", where_, name, problem));
}

const char* Attributes::Text(const char* name) const {
  const char* text = mj_getPluginConfig(model_, instance_, name);
  return text != nullptr ? text : "";
}

bool Attributes::Has(const char* name) const {
  return std::string_view(Text(name)).find_first_not_of(kSpace) != std::string_view::npos;
}

template <class T>
std::vector<T> Attributes::Values(const char* name, const char* expected) const {
  std::vector<T> values;
  std::string_view rest = Text(name);
  while (true) {
    rest.remove_prefix(std::min(rest.find_first_not_of(kSpace), rest.size()));
    if (rest.empty()) return values;
    const std::string_view word = rest.substr(0, rest.find_first_of(kSpace));
    T value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !IsFinite(value)) {
      Fail(name,
           fmt::format("has {} as value {}, expected {}", Quote(word), values.size(), expected));
    }
    values.push_back(value);
    rest.remove_prefix(word.size());
  }
}

double Attributes::Number(const char* name, double otherwise) const {
  if (!Has(name)) return otherwise;
  const std::vector<double> values = Values<double>(name, "a finite number");
  if (values.size() != 1) Fail(name, fmt::format("has {} values, expected one", values.size()));
  return values[0];
}

bool Attributes::Flag(const char* name, bool otherwise) const {
  const double value = Number(name, otherwise ? 1 : 0);
  if (value != 0 && value != 1) Fail(name, fmt::format("is {}, expected 0 or 1", value));
  return value == 1;
}

std::string_view Attributes::Word(const char* name,
                                  std::initializer_list<std::string_view> words) const {
  if (!Has(name)) return *words.begin();
  const auto word = std::find(words.begin(), words.end(), Text(name));
  if (word == words.end()) {
    Fail(name, fmt::format("is {}, expected {}", Quote(Text(name)), fmt::join(words, " or ")));
  }
  return *word;
}

std::vector<int> Attributes::Integers(const char* name) const {
  return Values<int>(name, "a whole number");
}

Eigen::VectorXd Attributes::Each(const char* name, Eigen::Index count) const {
  const std::vector<double> values = Values<double>(name, "a finite number");
  const Eigen::Index size = static_cast<Eigen::Index>(values.size());
  if (size == 1) return Eigen::VectorXd::Constant(count, values[0]);
  if (size != count) Fail(name, fmt::format("has {} values, expected 1 or {}", size, count));
  return Eigen::Map<const Eigen::VectorXd>(values.data(), size);
}

}  // namespace physpring

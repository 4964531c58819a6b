// SPDX-License-Identifier: Apache-2.0
// The <config> values of a plugin instance, as numbers. Ranges are checked by
// SpringMassSystem::Validate; unknown keys are refused by MuJoCo.
#ifndef PHYSPRING_PLUGIN_ATTRIBUTES_H_
#define PHYSPRING_PLUGIN_ATTRIBUTES_H_

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace physpring {

class Attributes {
 public:
  Attributes(const mjModel* model, int instance);

  // "physpring.springs 'rope'": how messages begin.
  const std::string& where() const { return where_; }

  // True if the attribute is given and not empty.
  bool Has(const char* name) const;
  const char* Text(const char* name) const;  // "" if it is not given

  // The following throw Error, one line that names instance, attribute and value, unless the text
  // is what they return.
  double Number(const char* name, double otherwise) const;
  bool Flag(const char* name, bool otherwise) const;  // 0 or 1
  // One of `words`; the first one if it is not given.
  std::string_view Word(const char* name, std::initializer_list<std::string_view> words) const;
  std::vector<int> Integers(const char* name) const;  // any number of them
  // `count` values; a single one stands for all.
  Eigen::VectorXd Each(const char* name, Eigen::Index count) const;

 private:
  template <class T>
  std::vector<T> Values(const char* name, const char* expected) const;
  [[noreturn]] void Fail(const char* name, const std::string& problem) const;

  const mjModel* model_;
  int instance_;
  std::string where_;
};

}  // namespace physpring

#endif  // PHYSPRING_PLUGIN_ATTRIBUTES_H_

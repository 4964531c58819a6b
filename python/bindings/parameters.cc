// SPDX-License-Identifier: Apache-2.0
#include "python/bindings/parameters.h"

#include <fmt/format.h>

#include <map>

#include "twin/contact_law.h"
#include "twin/npz.h"

namespace physpring {
namespace {

NamedNumbers Named(const std::string& name, Eigen::VectorXd* numbers) {
  return {name, numbers->data(), ExtentOf(numbers->size()), false};
}

NamedNumbers Scalar(const std::string& name, double* number) { return {name, number, 1, true}; }

// Of a system and of a gradient alike, whose members have the same names.
template <class Numbers, class Contact>
void AddCommon(Numbers* of, Contact* contact, Eigen::Vector3d* gravity,
               std::vector<NamedNumbers>* all) {
  *all = {Named("stiffness", &of->stiffness), Named("rest_length", &of->rest_length),
          Named("dashpot", &of->dashpot),     Named("mass", &of->mass),
          Scalar("drag", &of->drag),          {"gravity", gravity->data(), 3, false}};
  for (const auto& coefficient : kContactCoefficients<double>) {
    all->push_back(Scalar(coefficient.name, &(contact->surface.*coefficient.member)));
    all->push_back(Scalar(coefficient.object_name, &(contact->object.*coefficient.member)));
  }
}

// The names of a system's effects.
std::vector<std::string> EffectNames(const SpringMassSystem& system) {
  std::vector<std::string> names;
  std::map<std::string, int> count;
  for (const EffectValues& effect : system.effects) {
    const int nth = ++count[effect.name];
    names.push_back(nth == 1 ? effect.name : fmt::format("{}#{}", effect.name, nth));
  }
  return names;
}

}  // namespace

std::vector<NamedNumbers> ParametersOf(SpringMassSystem* system, Environment* environment) {
  std::vector<NamedNumbers> all;
  AddCommon(system, &system->contact, &environment->gravity, &all);
  const std::vector<std::string> names = EffectNames(*system);
  for (std::size_t i = 0; i < names.size(); ++i) {
    all.push_back(Named(names[i], &system->effects[i].values));
  }
  return all;
}

std::vector<NamedNumbers> GradientsOf(const SpringMassSystem& system, SystemGradient* gradient) {
  std::vector<NamedNumbers> all;
  AddCommon(gradient, &gradient->contact, &gradient->gravity, &all);
  const std::vector<std::string> names = EffectNames(system);
  for (std::size_t i = 0; i < names.size(); ++i) {
    all.push_back(Named(names[i], &gradient->effects[i]));
  }
  return all;
}

}  // namespace physpring

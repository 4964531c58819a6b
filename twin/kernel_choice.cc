// SPDX-License-Identifier: Apache-2.0
#include "twin/kernel_choice.h"

#include <fmt/format.h>

#include <cstdlib>
#include <vector>

#include "twin/error.h"
#include "twin/instruction_sets.h"
#include "twin/node_update.h"
#include "twin/quote.h"
#include "twin/spring_force.h"

namespace physpring {
namespace {

template <class Real>
constexpr Kernel<Real> kScalar = {"scalar",
                                  MeasureSprings<Real>,
                                  AddSpringForces<Real>,
                                  AddSpringForcesAdjoint<Real>,
                                  AddDashpotForces<Real>,
                                  AdvanceStage<Real>,
                                  UpdateVelocities<Real>,
                                  UpdateVelocitiesAdjoint<Real>,
                                  UpdatePositions<Real>,
                                  UpdatePositionsAdjoint<Real>};

}  // namespace

bool HasAvx512() {
#ifdef __x86_64__
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512vl");
#else
  return false;
#endif
}

template <class Real>
const Kernel<Real>* FindKernel(std::string_view name) {
  if (name == "scalar") return &kScalar<Real>;
#ifdef __x86_64__
  if (name == "avx2" && __builtin_cpu_supports("avx2")) return &Avx2Kernel<Real>();
  if (name == "avx512" && HasAvx512()) return &Avx512Kernel<Real>();
#endif
  return nullptr;
}

template <class Real>
const Kernel<Real>& ChooseKernel(std::string_view wish) {
  std::vector<std::string_view> names;  // the fastest last
  for (std::string_view name : kKernelNames) {
    if (FindKernel<Real>(name) != nullptr) names.push_back(name);
  }
  const Kernel<Real>* kernel = FindKernel<Real>(wish.empty() ? names.back() : wish);
  if (kernel != nullptr) return *kernel;
  throw Error(fmt::format("PHYSPRING_KERNEL={}: is no kernel for this processor; these are: {}",
                          Quote(wish), fmt::join(names, ", ")));
}

template <class Real>
const Kernel<Real>& BestKernel() {
  static const Kernel<Real>* const best = [] {
    const char* wish = std::getenv("PHYSPRING_KERNEL");
    return &ChooseKernel<Real>(wish != nullptr ? wish : "");
  }();
  return *best;
}

template const Kernel<float>* FindKernel(std::string_view);
template const Kernel<double>* FindKernel(std::string_view);
template const Kernel<float>& ChooseKernel(std::string_view);
template const Kernel<double>& ChooseKernel(std::string_view);
template const Kernel<float>& BestKernel();
template const Kernel<double>& BestKernel();

}  // namespace physpring

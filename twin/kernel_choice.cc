// SPDX-License-Identifier: Apache-2.0
#include "twin/kernel_choice.h"

#include <fmt/format.h>

#include <cstdlib>

#include "twin/error.h"
#include "twin/kernel_avx2.h"
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
                                  UpdateVelocities<Real>,
                                  UpdateVelocitiesAdjoint<Real>,
                                  UpdatePositions<Real>,
                                  UpdatePositionsAdjoint<Real>};

}  // namespace

template <class Real>
const Kernel<Real>* FindKernel(std::string_view name) {
  if (name == "scalar") return &kScalar<Real>;
#ifdef __x86_64__
  if (name == "avx2" && __builtin_cpu_supports("avx2")) return &Avx2Kernel<Real>();
#endif
  return nullptr;
}

template <class Real>
const Kernel<Real>& ChooseKernel(std::string_view wish) {
  const Kernel<Real>* best = FindKernel<Real>("avx2");
  const Kernel<Real>* kernel = !wish.empty() ? FindKernel<Real>(wish) : best;
  if (kernel != nullptr) return *kernel;
  if (wish.empty()) return kScalar<Real>;
  throw Error(fmt::format("PHYSPRING_KERNEL={}: is no kernel for this processor; scalar{}",
                          Quote(wish), best != nullptr ? " and avx2 are" : " is"));
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

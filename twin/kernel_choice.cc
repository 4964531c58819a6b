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
                                  AddSpringForces<Real>,
                                  AddSpringForcesAdjoint<Real>,
                                  UpdateVelocities<Real>,
                                  UpdateVelocitiesAdjoint<Real>,
                                  UpdatePositions<Real>,
                                  UpdatePositionsAdjoint<Real>};

const char* ChooseKernel() {
  const char* forced = std::getenv("PHYSPRING_KERNEL");
  if (forced == nullptr || *forced == '\0') {
    return FindKernel<double>("avx2") != nullptr ? "avx2" : "scalar";
  }
  if (FindKernel<double>(forced) == nullptr) {
    throw Error(
        fmt::format("PHYSPRING_KERNEL={}: cannot run here; the kernels are scalar and, on "
                    "processors that have it, avx2",
                    Quote(forced)));
  }
  return forced;
}

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
const Kernel<Real>& BestKernel() {
  static const Kernel<Real>& best = *FindKernel<Real>(ChooseKernel());
  return best;
}

template const Kernel<float>* FindKernel(std::string_view);
template const Kernel<double>* FindKernel(std::string_view);
template const Kernel<float>& BestKernel();
template const Kernel<double>& BestKernel();

}  // namespace physpring

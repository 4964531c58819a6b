// SPDX-License-Identifier: Apache-2.0
#include "twin/lane_kernels.h"

#include <algorithm>
#include <cstdlib>

#include "twin/instruction_sets.h"
#include "twin/kernel_choice.h"

namespace physpring {
namespace {

bool IsAllowed(std::string_view name) {
  static const char* const wish = std::getenv("PHYSPRING_KERNEL");
  return wish == nullptr || *wish == 0 || name == wish;
}

}  // namespace

template <class Real>
const LaneKernel<Real>* FindLaneKernel([[maybe_unused]] std::string_view name) {
#ifdef __x86_64__
  if (name == "avx2" && __builtin_cpu_supports("avx2")) return &Avx2LaneKernel<Real>();
  if (name == "avx512" && HasAvx512()) return &Avx512LaneKernel<Real>();
#endif
  return nullptr;
}

template <class Real>
const LaneKernel<Real>* BestLaneKernel(int count) {
  const LaneKernel<Real>* best = nullptr;
  double least = 1;  // time for each, in that of a single rollout
  for (std::string_view name : kKernelNames) {
    const LaneKernel<Real>* kernel = IsAllowed(name) ? FindLaneKernel<Real>(name) : nullptr;
    if (kernel == nullptr) continue;
    const double time = kernel->time / std::min(count, kernel->lanes);
    if (time >= least) continue;
    least = time;
    best = kernel;
  }
  return best;
}

template const LaneKernel<float>* FindLaneKernel(std::string_view);
template const LaneKernel<double>* FindLaneKernel(std::string_view);
template const LaneKernel<float>* BestLaneKernel(int);
template const LaneKernel<double>* BestLaneKernel(int);

}  // namespace physpring

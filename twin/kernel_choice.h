// SPDX-License-Identifier: Apache-2.0
// Which kernel (kernel.h) computes the sub-steps.
#ifndef PHYSPRING_TWIN_KERNEL_CHOICE_H_
#define PHYSPRING_TWIN_KERNEL_CHOICE_H_

#include <array>
#include <string_view>

#include "twin/kernel.h"

namespace physpring {

// Whether this processor has the parts of AVX-512 that kernels are compiled for.
bool HasAvx512();

// The names of all kernels, those that are faster later.
inline constexpr std::array<std::string_view, 3> kKernelNames = {"scalar", "avx2", "avx512"};

// The kernel of that name; null where the processor cannot run it.
template <class Real>
const Kernel<Real>* FindKernel(std::string_view name);

// The kernel named `wish`, or the fastest that this processor can run if `wish` is empty. Throws
// Error if `wish` names one that cannot run here.
template <class Real>
const Kernel<Real>& ChooseKernel(std::string_view wish);

// The choice for the environment variable PHYSPRING_KERNEL, which is read once.
template <class Real>
const Kernel<Real>& BestKernel();

}  // namespace physpring

#endif  // PHYSPRING_TWIN_KERNEL_CHOICE_H_

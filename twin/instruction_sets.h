// SPDX-License-Identifier: Apache-2.0
// The kernels for instruction sets that not every processor of the family has, each in a file of
// its own that alone is compiled for the set. Only a processor that has it may call their
// functions: kernel_choice.h and lane_kernels.h see to that.
#ifndef PHYSPRING_TWIN_INSTRUCTION_SETS_H_
#define PHYSPRING_TWIN_INSTRUCTION_SETS_H_

#include "twin/kernel.h"
#include "twin/lane_kernel.h"

namespace physpring {

template <class Real>
const Kernel<Real>& Avx2Kernel();
template <class Real>
const Kernel<Real>& Avx512Kernel();

template <class Real>
const LaneKernel<Real>& Avx2LaneKernel();
template <class Real>
const LaneKernel<Real>& Avx512LaneKernel();

}  // namespace physpring

#endif  // PHYSPRING_TWIN_INSTRUCTION_SETS_H_

// SPDX-License-Identifier: Apache-2.0
// Which kernels there are for rollouts side by side (lane_kernel.h).
#ifndef PHYSPRING_TWIN_LANE_KERNELS_H_
#define PHYSPRING_TWIN_LANE_KERNELS_H_

#include <string_view>

#include "twin/lane_kernel.h"

namespace physpring {

// The kernel named "avx2" or "avx512"; null where the processor cannot run it. There is none named
// "scalar": without vectors, rollouts follow one another.
template <class Real>
const LaneKernel<Real>* FindLaneKernel(std::string_view name);

// The kernel with which each of `count` rollouts takes the least time, as many as there are lanes
// at once. Null where single rollouts take less time than a register that is mostly empty. The
// environment variable PHYSPRING_KERNEL, where it is set, names the only one allowed.
template <class Real>
const LaneKernel<Real>* BestLaneKernel(int count);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_LANE_KERNELS_H_

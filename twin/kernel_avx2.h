// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_TWIN_KERNEL_AVX2_H_
#define PHYSPRING_TWIN_KERNEL_AVX2_H_

#include "twin/kernel.h"

namespace physpring {

// For processors with AVX2; only they may call its functions.
template <class Real>
const Kernel<Real>& Avx2Kernel();

}  // namespace physpring

#endif  // PHYSPRING_TWIN_KERNEL_AVX2_H_

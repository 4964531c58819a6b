// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_SPLATS_IN_PARALLEL_H_
#define PHYSPRING_SPLATS_IN_PARALLEL_H_

#include <algorithm>

#include "twin/parallel.h"

namespace physpring {

// Calls use(0) ... use(count - 1), each once, on up to `threads` threads, which take many at once:
// for work that is too short to be handed out one by one.
template <class Use>
void InParallel(int count, int threads, const Use& use) {
  constexpr int kAtOnce = 1024;
  ParallelFor((count + kAtOnce - 1) / kAtOnce, threads, [&](int block) {
    const int end = std::min(count, (block + 1) * kAtOnce);
    for (int i = block * kAtOnce; i < end; ++i) use(i);
  });
}

}  // namespace physpring

#endif  // PHYSPRING_SPLATS_IN_PARALLEL_H_

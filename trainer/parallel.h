// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_TRAINER_PARALLEL_H_
#define PHYSPRING_TRAINER_PARALLEL_H_

#include <functional>
#include <vector>

namespace physpring {

// Calls work(0) ... work(count - 1), each once, on up to `threads` threads. The first exception
// thrown by a call (lowest index) is thrown again when all have ended. Results that go to places of
// their own do not depend on the number of threads.
void ParallelFor(int count, int threads, const std::function<void(int)>& work);

// Calls work(item, share) at the same time for the first of `items`, as many as there are threads,
// each with its share of the threads. Needs an item.
void ParallelFirst(const std::vector<int>& items, int threads,
                   const std::function<void(int, int)>& work);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_PARALLEL_H_

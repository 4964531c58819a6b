// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_TWIN_PARALLEL_H_
#define PHYSPRING_TWIN_PARALLEL_H_

#include <functional>
#include <vector>

namespace physpring {

// Calls work(0) ... work(count - 1), each once, on up to `threads` threads. The first exception
// thrown by a call (lowest index) is thrown again when all have ended; a wish to
// stop (twin/stop_request.h) is one. Results that go to places of
// their own do not depend on the number of threads.
void ParallelFor(int count, int threads, const std::function<void(int)>& work);

// The same, for work that can use several threads itself: work(i, share), where share() tells how
// many threads this call may use now. It grows as other calls end.
void ParallelShared(int count, int threads,
                    const std::function<void(int, const std::function<int()>&)>& work);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_PARALLEL_H_

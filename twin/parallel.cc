// SPDX-License-Identifier: Apache-2.0
#include "twin/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

#include "twin/stop_request.h"

namespace physpring {

void ParallelFor(int count, int threads, const std::function<void(int)>& work) {
  std::vector<std::exception_ptr> errors(count);
  std::atomic<int> next{0};
  const auto run = [&] {
    for (int i = next++; i < count; i = next++) {
      try {
        StopIfRequested();
        work(i);
      } catch (...) {
        errors[i] = std::current_exception();
      }
    }
  };
  std::vector<std::jthread> helpers;
  for (int t = 1; t < std::min(threads, count); ++t) helpers.emplace_back(run);
  run();
  helpers.clear();  // joins
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

void ParallelShared(int count, int threads,
                    const std::function<void(int, const std::function<int()>&)>& work) {
  std::atomic<int> left{count};
  const std::function<int()> share = [&] {
    return threads / std::max(1, std::min(threads, left.load()));
  };
  ParallelFor(count, threads, [&](int i) {
    work(i, share);
    --left;
  });
}

}  // namespace physpring

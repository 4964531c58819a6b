// SPDX-License-Identifier: Apache-2.0
#include "trainer/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

namespace physpring {

void ParallelFor(int count, int threads, const std::function<void(int)>& work) {
  std::vector<std::exception_ptr> errors(count);
  std::atomic<int> next{0};
  const auto run = [&] {
    for (int i = next++; i < count; i = next++) {
      try {
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

void ParallelFirst(const std::vector<int>& items, int threads,
                   const std::function<void(int, int)>& work) {
  const int count = std::min(threads, static_cast<int>(items.size()));
  ParallelFor(count, count, [&](int i) { work(items[i], threads / count); });
}

}  // namespace physpring

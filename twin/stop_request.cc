// SPDX-License-Identifier: Apache-2.0
#include "twin/stop_request.h"

#include <atomic>

namespace physpring {
namespace {

// Global, because a signal handler has no other way to tell.
std::atomic<bool> stop_wanted{false};
static_assert(std::atomic<bool>::is_always_lock_free);

}  // namespace

void RequestStop(bool wanted) noexcept { stop_wanted.store(wanted, std::memory_order_relaxed); }

void StopIfRequested() {
  if (stop_wanted.load(std::memory_order_relaxed)) throw Stopped();
}

}  // namespace physpring

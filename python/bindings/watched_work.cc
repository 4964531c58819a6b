// SPDX-License-Identifier: Apache-2.0
#include "python/bindings/watched_work.h"

#include <nanobind/stl/string.h>

#include <chrono>
#include <exception>
#include <future>
#include <mutex>
#include <optional>
#include <utility>

#include "twin/stop_request.h"

namespace physpring {
namespace {

namespace nb = nanobind;
constexpr std::chrono::milliseconds kPause(50);

// What was told last, until it is taken.
class Told {
 public:
  void Put(double share, const std::string& status) {
    const std::lock_guard<std::mutex> lock(mutex_);
    last_ = {share, status};
  }
  std::optional<std::pair<double, std::string>> Take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::exchange(last_, std::nullopt);
  }

 private:
  std::mutex mutex_;
  std::optional<std::pair<double, std::string>> last_;
};

// Needs the interpreter's lock. Throws what Python has thrown.
void LookUp(const nb::object& callback, Told* told) {
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
  const auto news = told->Take();
  if (news && !callback.is_none()) callback(news->first, news->second);
}

}  // namespace

void RunWatched(const nb::object& callback,
                const std::function<void(const TellShare& tell)>& work) {
  Told told;
  std::exception_ptr stopped;  // by the caller
  RequestStop(false);
  std::future<void> done;
  {
    const nb::gil_scoped_release unlocked;
    done = std::async(std::launch::async, [&] {
      work([&](double share, const std::string& status) { told.Put(share, status); });
    });
  }
  for (bool ready = false; !ready;) {
    {
      const nb::gil_scoped_release unlocked;
      ready = done.wait_for(kPause) == std::future_status::ready;
    }
    if (stopped) continue;
    try {
      LookUp(callback, &told);
    } catch (...) {
      stopped = std::current_exception();
      RequestStop(true);
    }
  }
  RequestStop(false);
  try {
    done.get();
  } catch (...) {
    if (!stopped) throw;
  }
  if (stopped) std::rethrow_exception(stopped);
}

}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
// Long work of Python: it runs without the interpreter's lock, in a thread of its own, while the
// thread that asked for it looks for Ctrl-C and tells how far the work is.
#ifndef PHYSPRING_PYTHON_BINDINGS_WATCHED_WORK_H_
#define PHYSPRING_PYTHON_BINDINGS_WATCHED_WORK_H_

#include <nanobind/nanobind.h>

#include <functional>
#include <string>

namespace physpring {

// How far work is; any thread may call it.
using TellShare = std::function<void(double share, const std::string& status)>;

// Runs `work` and hands `callback` (None, or a function of share and status) what it tells, from
// the calling thread. After Ctrl-C, or where the callback throws, the work is asked to stop
// (twin/stop_request.h) and that exception goes on; what `work` throws goes on, too.
void RunWatched(const nanobind::object& callback,
                const std::function<void(const TellShare& tell)>& work);

}  // namespace physpring

#endif  // PHYSPRING_PYTHON_BINDINGS_WATCHED_WORK_H_

// SPDX-License-Identifier: Apache-2.0
// A wish of the user to stop long work soon. Work looks at it again and again, at least once a
// frame, and ends by an exception. What is half done is dropped; what was kept before stays.
#ifndef PHYSPRING_TWIN_STOP_REQUEST_H_
#define PHYSPRING_TWIN_STOP_REQUEST_H_

namespace physpring {

// Not an error, so that nobody takes it for one.
struct Stopped {};

// Asks all threads to stop, or no longer. A signal handler may call this.
void RequestStop(bool wanted) noexcept;

// Throws Stopped if that was asked for.
void StopIfRequested();

}  // namespace physpring

#endif  // PHYSPRING_TWIN_STOP_REQUEST_H_

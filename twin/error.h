// SPDX-License-Identifier: Apache-2.0
// The one exception type of the libraries: bad input, in one line that says what, where and what
// would be right. Only cli/ catches it, prints it and exits with status 1.
#ifndef PHYSPRING_TWIN_ERROR_H_
#define PHYSPRING_TWIN_ERROR_H_

#include <stdexcept>

namespace physpring {

class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_ERROR_H_

// SPDX-License-Identifier: Apache-2.0
// The paired block bootstrap: is one model better than another on the same frames by more than
// chance? Neighbouring frames are alike, so whole blocks of them are drawn.
#ifndef PHYSPRING_DIAGNOSIS_BLOCK_BOOTSTRAP_H_
#define PHYSPRING_DIAGNOSIS_BLOCK_BOOTSTRAP_H_

#include <cstdint>
#include <vector>

namespace physpring {

struct BootstrapResult {
  double mean = 0;  // the mean of the differences
  double low = 0;   // bounds of its 95 % interval
  double high = 0;
  double error = 0;  // standard error of the mean
  double p = 1;      // share of draws with a mean of 0 or less
};

// p - q, frame by frame. Both are of the same frames.
std::vector<double> Difference(const std::vector<double>& p, const std::vector<double>& q);

// `difference` is the error of the first model minus that of the second in each frame. `block` is
// the number of frames drawn together, at most a quarter of all.
BootstrapResult BlockBootstrap(const std::vector<double>& difference, int block, int draws,
                               std::uint64_t seed);

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_BLOCK_BOOTSTRAP_H_

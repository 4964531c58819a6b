// SPDX-License-Identifier: Apache-2.0
// The paired block bootstrap: is one model better than another on the same frames by more than
// chance? Neighbouring frames are alike, so whole blocks of them are drawn.
#ifndef PHYSPRING_TRAINER_DIAGNOSIS_BLOCK_BOOTSTRAP_H_
#define PHYSPRING_TRAINER_DIAGNOSIS_BLOCK_BOOTSTRAP_H_

#include <cstdint>
#include <vector>

namespace physpring {

struct BootstrapResult {
  double mean = 0;  // of the differences
  double low = 0;   // bounds of a 95 % interval of it
  double high = 0;
  double error = 0;  // standard error of the mean
  double p = 1;      // share of draws with a mean of 0 or less
};

// Frame by frame, p - q; both of the same frames.
std::vector<double> Difference(const std::vector<double>& p, const std::vector<double>& q);

// `difference`: error of the first model minus that of the second, of each frame. `block`: frames,
// at most a quarter of all.
BootstrapResult BlockBootstrap(const std::vector<double>& difference, int block, int draws,
                               std::uint64_t seed);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_DIAGNOSIS_BLOCK_BOOTSTRAP_H_

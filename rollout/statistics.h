// SPDX-License-Identifier: Apache-2.0
// What numbers of successes say, and how alike two systems judge.
#ifndef PHYSPRING_ROLLOUT_STATISTICS_H_
#define PHYSPRING_ROLLOUT_STATISTICS_H_

#include <optional>
#include <vector>

namespace physpring {

struct Interval {
  double low = 0, high = 1;
};

// Wilson's 95 % interval of the rate behind `successes` of `trials`; 0 to 1 without trials.
Interval WilsonInterval(int successes, int trials);

// Verdicts of two systems on the same episodes.
struct PairedVerdicts {
  int both = 0, only_first = 0, only_second = 0, neither = 0;

  int count() const { return both + only_first + only_second + neither; }
  double Agreement() const;  // share of episodes with the same verdict; 0 without episodes

  // Cohen's kappa: agreement beyond what the two rates give by chance; nothing where one of the
  // verdicts never occurs.
  std::optional<double> Kappa() const;

  // McNemar's exact test: the probability, were neither system more successful, of discordant
  // episodes split as unevenly as these.
  double McNemar() const;
};

// Pearson's correlation; nothing for fewer than two values or where one side is constant.
std::optional<double> Pearson(const std::vector<double>& first, const std::vector<double>& second);

// Mean maximum rank violation (SIMPLER, Li et al. 2024) of the success rates `tested` of policies
// against `reference`:
//   mean_i max_j |R_i - R_j| [(S_i < S_j) != (R_i < R_j)],
// 0 where both order the policies alike.
double MeanMaximumRankViolation(const std::vector<double>& reference,
                                const std::vector<double>& tested);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_STATISTICS_H_

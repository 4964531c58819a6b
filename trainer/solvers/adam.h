// SPDX-License-Identifier: Apache-2.0
// Adam (Kingma and Ba 2015), with a learning rate for each entry.
#ifndef PHYSPRING_TRAINER_SOLVERS_ADAM_H_
#define PHYSPRING_TRAINER_SOLVERS_ADAM_H_

#include <Eigen/Core>
#include <cmath>

namespace physpring {

struct Adam {
  double beta1 = 0.9, beta2 = 0.99, epsilon = 1e-12;
  int steps = 0;
  Eigen::VectorXd mean, mean_square;  // running means of the gradient and its square

  explicit Adam(Eigen::Index size)
      : mean(Eigen::VectorXd::Zero(size)), mean_square(Eigen::VectorXd::Zero(size)) {}

  // What a journal keeps (journal/packing.h).
  template <class Visitor>
  void Visit(Visitor&& visit) {
    visit(steps, mean, mean_square);
  }

  // values <- values - rate * mean / sqrt(mean_square), bias-corrected. An entry that never had a
  // gradient does not move.
  void Step(const Eigen::VectorXd& gradient, const Eigen::VectorXd& rate, Eigen::VectorXd* values) {
    ++steps;
    mean = beta1 * mean + (1 - beta1) * gradient;
    mean_square = beta2 * mean_square + (1 - beta2) * gradient.cwiseAbs2();
    const double correction1 = 1 - std::pow(beta1, steps);
    const double correction2 = 1 - std::pow(beta2, steps);
    for (Eigen::Index i = 0; i < values->size(); ++i) {
      const double root = std::sqrt(mean_square[i] / correction2);
      (*values)[i] -= rate[i] * (mean[i] / correction1) / (root + epsilon);
    }
  }
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_SOLVERS_ADAM_H_

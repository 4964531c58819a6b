// SPDX-License-Identifier: Apache-2.0
#include "twin/effects/spring_effect.h"

#include <algorithm>

#include "twin/spring_law.h"

namespace physpring {

void SpringBatch::Measure(const SpringMassSystem& system, const Instant& instant, int first) {
  ends_ = system.springs.data() + first;
  k_ = system.stiffness.data() + first;
  L_ = system.rest_length.data() + first;
  first_ = first;
  count_ = std::min(kMost, system.spring_count() - first);
  const double *x = instant.x.data(), *v = instant.v.data();
  for (int i = 0; i < count_; ++i) {
    const auto [a, b] = ends_[i];
    for (int j = 0; j < 3; ++j) {
      n_[j].coeffRef(i) = x[3 * b + j] - x[3 * a + j];
      u_[j].coeffRef(i) = v[3 * b + j] - v[3 * a + j];
    }
  }
  length_ = (n_[0].square() + n_[1].square() + n_[2].square()).sqrt();
  Row inverse = length_.inverse();
  inverse = (length_ < kShortest).select(0, inverse);
  for (Row& n : n_) n *= inverse;
  rate_ = n_[0] * u_[0] + n_[1] * u_[1] + n_[2] * u_[2];
}

void SpringBatch::AddForces(const double* tension, Points* force) const {
  double* f = force->data();
  for (int i = 0; i < count_; ++i) {
    const auto [a, b] = ends_[i];
    for (int j = 0; j < 3; ++j) {
      const double pull = tension[i] * n_[j].coeff(i);
      f[3 * a + j] += pull;
      f[3 * b + j] -= pull;
    }
  }
}

void SpringBatch::TensionBar(const Points& force_bar, double* tension_bar) const {
  for (int i = 0; i < count_; ++i) {
    const auto [a, b] = ends_[i];
    tension_bar[i] = 0;
    for (int j = 0; j < 3; ++j) {
      tension_bar[i] += n_[j].coeff(i) * (force_bar(j, a) - force_bar(j, b));
    }
  }
}

void SpringBatch::AddAdjoint(int i, double tension, const SpringMoment& bar,
                             const Points& force_bar, InstantGradient* gradient) const {
  gradient->parameters->stiffness[first_ + i] += bar.stiffness;
  gradient->parameters->rest_length[first_ + i] += bar.rest_length;
  const Eigen::Vector3d n(n_[0][i], n_[1][i], n_[2][i]), u(u_[0][i], u_[1][i], u_[2][i]);
  if (n.isZero()) return;
  const auto [a, b] = ends_[i];
  const Eigen::Vector3d w = force_bar.col(a) - force_bar.col(b);
  // forward: F_a += T n, F_b -= T n, rate = n . u, n = d / l, l = |d|
  const Eigen::Vector3d n_bar = tension * w + bar.rate * u;
  const Eigen::Vector3d d_bar = bar.length * n + (n_bar - n.dot(n_bar) * n) / length_[i];
  gradient->x.col(a) -= d_bar;
  gradient->x.col(b) += d_bar;
  gradient->v.col(a) -= bar.rate * n;
  gradient->v.col(b) += bar.rate * n;
}

}  // namespace physpring

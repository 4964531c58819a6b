// SPDX-License-Identifier: Apache-2.0
#include "trainer/network/tape.h"

#include <cmath>
#include <utility>

namespace physpring {
namespace {

constexpr double kVarianceFloor = 1e-5;   // added to the variance of a row that is normalised
constexpr double kDistanceFloor = 1e-12;  // added to the square; keeps the derivative at 0 finite

void AddTo(Features* sum, const Features& term) {
  if (sum->size() == 0) {
    *sum = term;
  } else {
    *sum += term;
  }
}

}  // namespace

Tape::Tape(const Eigen::VectorXd& weights) : weights_(weights) {}

Tape::Node Tape::Record(Features value, AddAdjoint add_adjoint) {
  values_.push_back(std::move(value));
  adjoints_.push_back(std::move(add_adjoint));
  return {static_cast<int>(values_.size()) - 1};
}

Tape::Node Tape::Constant(Features value) { return Record(std::move(value), nullptr); }

Tape::Node Tape::Weight(int offset, int rows, int columns) {
  const Eigen::Map<const Features> block(weights_.data() + offset, rows, columns);
  return Record(block, [=](const Features& bar, Bars*, Eigen::VectorXd* weights_bar) {
    // forward: block = weights[offset ...]
    Eigen::Map<Features>(weights_bar->data() + offset, rows, columns) += bar;
  });
}

Tape::Node Tape::Product(Node a, Node b) {
  return Record(values_[a.index] * values_[b.index],
                [=, this](const Features& bar, Bars* bars, Eigen::VectorXd*) {
                  // forward: c = a b
                  if (adjoints_[a.index]) {
                    AddTo(&(*bars)[a.index], bar * values_[b.index].transpose());
                  }
                  if (adjoints_[b.index]) {
                    AddTo(&(*bars)[b.index], values_[a.index].transpose() * bar);
                  }
                });
}

Tape::Node Tape::Sum(Node a, Node b) {
  return Record(values_[a.index] + values_[b.index],
                [=](const Features& bar, Bars* bars, Eigen::VectorXd*) {
                  // forward: c = a + b
                  AddTo(&(*bars)[a.index], bar);
                  AddTo(&(*bars)[b.index], bar);
                });
}

Tape::Node Tape::AddToRows(Node a, Node row) {
  return Record(values_[a.index].rowwise() + values_[row.index].row(0),
                [=](const Features& bar, Bars* bars, Eigen::VectorXd*) {
                  // forward: c_i = a_i + row
                  AddTo(&(*bars)[a.index], bar);
                  AddTo(&(*bars)[row.index], bar.colwise().sum());
                });
}

Tape::Node Tape::Swish(Node a) {
  const Features sigmoid = (1 + (-values_[a.index].array()).exp()).inverse();
  return Record(values_[a.index].cwiseProduct(sigmoid), [=, this](const Features& bar, Bars* bars,
                                                                  Eigen::VectorXd*) {
    // forward: c = a s(a), s' = s (1 - s)
    const Features slope = sigmoid.array() * (1 + values_[a.index].array() * (1 - sigmoid.array()));
    AddTo(&(*bars)[a.index], bar.cwiseProduct(slope));
  });
}

Tape::Node Tape::BoundedBy(Node a, double bound) {
  const Features t = values_[a.index].array().tanh();
  return Record(bound * t, [=](const Features& bar, Bars* bars, Eigen::VectorXd*) {
    // forward: c = bound tanh(a)
    AddTo(&(*bars)[a.index], bound * bar.cwiseProduct(Features(1 - t.array().square())));
  });
}

Tape::Node Tape::Normalise(Node a) {
  Features centred = values_[a.index];
  centred.colwise() -= Eigen::VectorXd(centred.rowwise().mean());
  const Eigen::VectorXd inverse =
      (centred.rowwise().squaredNorm().array() / static_cast<double>(centred.cols()) +
       kVarianceFloor)
          .sqrt()
          .inverse();
  Features normal = inverse.asDiagonal() * centred;
  return Record(normal, [=](const Features& bar, Bars* bars, Eigen::VectorXd*) {
    // forward: n = (a - mean) / sqrt(variance + floor)
    const Eigen::VectorXd along = bar.cwiseProduct(normal).rowwise().mean();
    Features a_bar = bar - along.asDiagonal() * normal;
    a_bar.colwise() -= Eigen::VectorXd(bar.rowwise().mean());
    AddTo(&(*bars)[a.index], inverse.asDiagonal() * a_bar);
  });
}

Tape::Node Tape::Gather(Node a, std::vector<int> rows) {
  const Features& from = values_[a.index];
  Features gathered(static_cast<Eigen::Index>(rows.size()), from.cols());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    gathered.row(static_cast<Eigen::Index>(i)) = from.row(rows[i]);
  }
  return Record(std::move(gathered), [=, this, rows = std::move(rows)](
                                         const Features& bar, Bars* bars, Eigen::VectorXd*) {
    // forward: c_i = a_rows[i]
    Features& a_bar = (*bars)[a.index];
    if (a_bar.size() == 0) a_bar.setZero(values_[a.index].rows(), bar.cols());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      a_bar.row(rows[i]) += bar.row(static_cast<Eigen::Index>(i));
    }
  });
}

Tape::Node Tape::MeanInto(Node a, std::vector<int> rows, int count) {
  const Features& from = values_[a.index];
  Features mean = Features::Zero(count, from.cols());
  Eigen::VectorXd members = Eigen::VectorXd::Zero(count);
  for (int row : rows) {
    if (row >= 0) ++members[row];
  }
  const Eigen::VectorXd share = members.cwiseMax(1).cwiseInverse();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i] >= 0) mean.row(rows[i]) += share[rows[i]] * from.row(static_cast<Eigen::Index>(i));
  }
  return Record(std::move(mean), [=, rows = std::move(rows)](const Features& bar, Bars* bars,
                                                             Eigen::VectorXd*) {
    // forward: c_r += a_i / n_r, r = rows[i]
    Features a_bar = Features::Zero(static_cast<Eigen::Index>(rows.size()), bar.cols());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows[i] >= 0) {
        a_bar.row(static_cast<Eigen::Index>(i)) = share[rows[i]] * bar.row(rows[i]);
      }
    }
    AddTo(&(*bars)[a.index], a_bar);
  });
}

Tape::Node Tape::MeanOfRows(Node a) {
  const Eigen::Index rows = values_[a.index].rows();
  return Record(values_[a.index].colwise().mean(),
                [=](const Features& bar, Bars* bars, Eigen::VectorXd*) {
                  // forward: c = sum_i a_i / rows
                  AddTo(&(*bars)[a.index], bar.replicate(rows, 1) / static_cast<double>(rows));
                });
}

Tape::Node Tape::Distance(Node a, std::vector<std::array<int, 2>> pairs) {
  const Features& from = values_[a.index];
  Features distance(static_cast<Eigen::Index>(pairs.size()), 1);
  for (std::size_t e = 0; e < pairs.size(); ++e) {
    const double squared = (from.row(pairs[e][0]) - from.row(pairs[e][1])).squaredNorm();
    distance(static_cast<Eigen::Index>(e), 0) = std::sqrt(squared + kDistanceFloor);
  }
  return Record(distance, [=, this, pairs = std::move(pairs)](const Features& bar, Bars* bars,
                                                              Eigen::VectorXd*) {
    // forward: c_e = |a_i - a_j|
    Features& a_bar = (*bars)[a.index];
    if (a_bar.size() == 0) a_bar.setZero(values_[a.index].rows(), values_[a.index].cols());
    for (std::size_t e = 0; e < pairs.size(); ++e) {
      const auto [i, j] = pairs[e];
      const auto row = static_cast<Eigen::Index>(e);
      const Eigen::RowVectorXd part =
          bar(row, 0) / distance(row, 0) * (values_[a.index].row(i) - values_[a.index].row(j));
      a_bar.row(i) += part;
      a_bar.row(j) -= part;
    }
  });
}

void Tape::Backward(const std::vector<Seed>& seeds, Eigen::VectorXd* weights_bar) const {
  Bars bars(values_.size());
  for (const Seed& seed : seeds) AddTo(&bars[seed.node.index], seed.bar);
  for (std::size_t k = values_.size(); k-- > 0;) {
    if (bars[k].size() == 0 || !adjoints_[k]) continue;
    adjoints_[k](bars[k], &bars, weights_bar);
    bars[k].resize(0, 0);
  }
}

}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
// Reverse-mode differentiation of matrix expressions. A tape records each operation with its value;
// Backward goes through them in reverse. Rows are nodes or springs, columns are features. Each
// operation stands beside its adjoint in tape.cc.
#ifndef PHYSPRING_TRAINER_NETWORK_TAPE_H_
#define PHYSPRING_TRAINER_NETWORK_TAPE_H_

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

namespace physpring {

// Row by row in memory, so that a node's features lie together.
using Features = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

class Tape {
 public:
  // A value on the tape.
  struct Node {
    int index;
  };

  // The weights that Weight refers to; they must outlive the tape.
  explicit Tape(const Eigen::VectorXd& weights);

  Node Constant(Features value);
  // A rows x columns block of the weights, row by row, from `offset` on.
  Node Weight(int offset, int rows, int columns);

  Node Product(Node a, Node b);                // a b
  Node Sum(Node a, Node b);                    // a + b
  Node AddToRows(Node a, Node row);            // a_i + row
  Node Swish(Node a);                          // a / (1 + exp(-a)), each entry
  Node BoundedBy(Node a, double bound);        // bound tanh(a), each entry
  Node Normalise(Node a);                      // each row to mean 0, variance 1 (layer norm)
  Node Gather(Node a, std::vector<int> rows);  // row i is a's row rows[i]
  // Row r is the mean of a's rows i with rows[i] == r, 0 where there is none. A row may go nowhere
  // (-1).
  Node MeanInto(Node a, std::vector<int> rows, int count);
  Node MeanOfRows(Node a);  // one row
  // Row e is |a_i - a_j| for the pair (i, j) = pairs[e]: one column.
  Node Distance(Node a, std::vector<std::array<int, 2>> pairs);

  const Features& value(Node a) const { return values_[a.index]; }

  // Adds d loss / d weights to `weights_bar`, for the loss whose derivatives with respect to some
  // of the tape's values are given.
  struct Seed {
    Node node;
    Features bar;
  };
  void Backward(const std::vector<Seed>& seeds, Eigen::VectorXd* weights_bar) const;

 private:
  using Bars = std::vector<Features>;
  // Adds to the bars of the operands what follows from the bar of the result.
  using AddAdjoint = std::function<void(const Features& bar, Bars* bars, Eigen::VectorXd* weights)>;

  Node Record(Features value, AddAdjoint add_adjoint);

  const Eigen::VectorXd& weights_;
  std::vector<Features> values_;
  std::vector<AddAdjoint> adjoints_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_NETWORK_TAPE_H_

// SPDX-License-Identifier: Apache-2.0
// The weights of a network in one vector, and its layers as blocks of it.
#ifndef PHYSPRING_TRAINER_NETWORK_WEIGHTS_H_
#define PHYSPRING_TRAINER_NETWORK_WEIGHTS_H_

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "trainer/network/tape.h"

namespace physpring {

// y = x W + b.
struct LinearLayer {
  int offset = 0, inputs = 0, outputs = 0;

  Tape::Node Apply(Tape* tape, Tape::Node x) const {
    const Tape::Node w = tape->Weight(offset, inputs, outputs);
    return tape->AddToRows(tape->Product(x, w),
                           tape->Weight(offset + inputs * outputs, 1, outputs));
  }
};

// Swish between two linear layers.
struct Mlp {
  LinearLayer first, second;

  Tape::Node Apply(Tape* tape, Tape::Node x) const {
    return second.Apply(tape, tape->Swish(first.Apply(tape, x)));
  }
};

// Lays layers out one after the other and draws their first weights: normal with variance
// 1 / inputs, biases 0; layers that are to do nothing at first are 0.
class WeightLayout {
 public:
  explicit WeightLayout(std::uint64_t seed) : random_(seed) {}

  LinearLayer Linear(int inputs, int outputs, bool zero = false) {
    const LinearLayer layer{static_cast<int>(values_.size()), inputs, outputs};
    const double deviation = zero ? 0 : 1 / std::sqrt(static_cast<double>(inputs));
    for (int k = 0; k < inputs * outputs; ++k) values_.push_back(deviation * Normal());
    values_.resize(values_.size() + outputs, 0.0);
    return layer;
  }
  Mlp TwoLayers(int inputs, int hidden, int outputs, bool zero = false) {
    const LinearLayer first = Linear(inputs, hidden);
    return {first, Linear(hidden, outputs, zero)};
  }

  Eigen::VectorXd Values() const {
    return Eigen::Map<const Eigen::VectorXd>(values_.data(),
                                             static_cast<Eigen::Index>(values_.size()));
  }

 private:
  // Box and Muller's method: the same with every standard library.
  double Normal() {
    const auto uniform = [this] { return (static_cast<double>(random_() >> 11) + 0.5) * 0x1p-53; };
    const double radius = std::sqrt(-2 * std::log(uniform()));
    return radius * std::cos(2 * M_PI * uniform());
  }

  std::mt19937_64 random_;
  std::vector<double> values_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_NETWORK_WEIGHTS_H_

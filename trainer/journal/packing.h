// SPDX-License-Identifier: Apache-2.0
// A state as a row of numbers, and back. A type lists its members once,
//   template <class Visitor> void Visit(Visitor&& visit) { visit(iteration, damping, x); }
// and can be kept in a journal. Members are numbers, vectors, matrices, lists of these, or types
// that have a Visit of their own.
#ifndef PHYSPRING_TRAINER_JOURNAL_PACKING_H_
#define PHYSPRING_TRAINER_JOURNAL_PACKING_H_

#include <Eigen/Core>
#include <type_traits>
#include <vector>

#include "twin/error.h"

namespace physpring {

class Packer {
 public:
  template <class... Members>
  void operator()(Members&... members) {
    (Add(members), ...);
  }
  Eigen::VectorXd numbers() const {
    return Eigen::Map<const Eigen::VectorXd>(numbers_.data(),
                                             static_cast<Eigen::Index>(numbers_.size()));
  }

 private:
  template <class T>
  void Add(T& member) {
    if constexpr (std::is_arithmetic_v<T>) {
      numbers_.push_back(static_cast<double>(member));
    } else {
      member.Visit(*this);
    }
  }
  void Add(Eigen::MatrixXd& matrix) {
    numbers_.push_back(static_cast<double>(matrix.rows()));
    numbers_.push_back(static_cast<double>(matrix.cols()));
    numbers_.insert(numbers_.end(), matrix.data(), matrix.data() + matrix.size());
  }
  void Add(Eigen::VectorXd& vector) {
    numbers_.push_back(static_cast<double>(vector.size()));
    numbers_.insert(numbers_.end(), vector.begin(), vector.end());
  }
  template <class T>
  void Add(std::vector<T>& list) {
    numbers_.push_back(static_cast<double>(list.size()));
    for (T& one : list) Add(one);
  }

  std::vector<double> numbers_;
};

class Unpacker {
 public:
  explicit Unpacker(const Eigen::VectorXd& numbers) : numbers_(numbers) {}

  template <class... Members>
  void operator()(Members&... members) {
    (Take(members), ...);
  }
  // Throws Error unless all numbers were taken.
  void ExpectEnd() const {
    if (at_ != numbers_.size()) throw Error("cannot resume: a kept state has too many numbers");
  }

 private:
  double Next() {
    if (at_ == numbers_.size()) throw Error("cannot resume: a kept state has too few numbers");
    return numbers_[at_++];
  }
  Eigen::Index NextSize() {
    const double size = Next();
    if (size >= 0 && size <= static_cast<double>(numbers_.size())) {
      return static_cast<Eigen::Index>(size);
    }
    throw Error("cannot resume: a kept state has a size that is none");
  }
  template <class T>
  void Take(T& member) {
    if constexpr (std::is_arithmetic_v<T>) {
      member = static_cast<T>(Next());
    } else {
      member.Visit(*this);
    }
  }
  void Take(Eigen::MatrixXd& matrix) {
    const Eigen::Index rows = NextSize(), columns = NextSize();
    if (rows * columns > numbers_.size()) throw Error("cannot resume: a kept matrix is cut off");
    matrix.resize(rows, columns);
    for (double& value : matrix.reshaped()) value = Next();
  }
  void Take(Eigen::VectorXd& vector) {
    vector.resize(NextSize());
    for (double& value : vector) value = Next();
  }
  template <class T>
  void Take(std::vector<T>& list) {
    list.resize(static_cast<std::size_t>(NextSize()));
    for (T& one : list) Take(one);
  }

  const Eigen::VectorXd& numbers_;
  Eigen::Index at_ = 0;
};

template <class State>
Eigen::VectorXd Pack(const State& state) {
  Packer packer;
  const_cast<State&>(state).Visit(packer);  // a packer only reads
  return packer.numbers();
}

// Throws Error if the numbers are none of such a state.
template <class State>
void Unpack(const Eigen::VectorXd& numbers, State* state) {
  Unpacker unpacker(numbers);
  state->Visit(unpacker);
  unpacker.ExpectEnd();
}

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_JOURNAL_PACKING_H_

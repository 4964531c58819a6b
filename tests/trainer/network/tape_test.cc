// SPDX-License-Identifier: Apache-2.0
#include "trainer/network/tape.h"

#include <gtest/gtest.h>

#include <functional>

#include "tests/support/gradient_check.h"
#include "tests/support/random_system.h"

namespace physpring {
namespace {

constexpr int kRows = 5, kColumns = 4;

Eigen::VectorXd RandomVector(Eigen::Index size, std::uint64_t seed) {
  Random random(seed);
  Eigen::VectorXd values(size);
  for (double& value : values) value = random(-1, 1);
  return values;
}

// The derivatives of sum(bar . operation(weights)) with respect to all weights.
void ExpectAdjointIsRight(const std::function<Tape::Node(Tape*)>& operation) {
  Eigen::VectorXd weights = RandomVector(60, 1);
  Tape tape(weights);
  const Tape::Node result = operation(&tape);
  const Features& value = tape.value(result);
  const Features bar =
      Eigen::Map<const Features>(RandomVector(value.size(), 2).data(), value.rows(), value.cols());
  Eigen::VectorXd weights_bar = Eigen::VectorXd::Zero(weights.size());
  tape.Backward({{result, bar}}, &weights_bar);
  std::vector<CheckedVariable> variables;
  for (int k = 0; k < weights.size(); ++k) {
    variables.push_back({std::to_string(k), &weights[k], 1e-3, weights_bar[k]});
  }
  const auto loss = [&] {
    Tape again(weights);
    return again.value(operation(&again)).cwiseProduct(bar).cast<long double>().sum();
  };
  const GradientReport report = CheckGradient(loss, variables);
  EXPECT_TRUE(report.passed) << report.log;
  EXPECT_GT(weights_bar.norm(), 0);
}

Tape::Node Left(Tape* tape) { return tape->Weight(0, kRows, kColumns); }

TEST(Tape, Product) {
  ExpectAdjointIsRight([](Tape* t) { return t->Product(Left(t), t->Weight(20, kColumns, 3)); });
}

TEST(Tape, Sum) {
  ExpectAdjointIsRight([](Tape* t) { return t->Sum(Left(t), t->Weight(20, kRows, kColumns)); });
}

TEST(Tape, AddToRows) {
  ExpectAdjointIsRight([](Tape* t) { return t->AddToRows(Left(t), t->Weight(20, 1, kColumns)); });
}

TEST(Tape, Swish) {
  ExpectAdjointIsRight([](Tape* t) { return t->Swish(Left(t)); });
}

TEST(Tape, BoundedBy) {
  ExpectAdjointIsRight([](Tape* t) { return t->BoundedBy(Left(t), 1.5); });
}

TEST(Tape, Normalise) {
  ExpectAdjointIsRight([](Tape* t) { return t->Normalise(Left(t)); });
}

TEST(Tape, Gather) {
  ExpectAdjointIsRight([](Tape* t) { return t->Gather(Left(t), {3, 0, 3, 1, 4, 4}); });
}

TEST(Tape, MeanInto) {
  ExpectAdjointIsRight([](Tape* t) { return t->MeanInto(Left(t), {1, -1, 1, 2, 1}, 4); });
}

TEST(Tape, MeanOfRows) {
  ExpectAdjointIsRight([](Tape* t) { return t->MeanOfRows(Left(t)); });
}

TEST(Tape, Distance) {
  ExpectAdjointIsRight([](Tape* t) { return t->Distance(Left(t), {{0, 1}, {1, 3}, {4, 0}}); });
}

TEST(Tape, AValueThatIsUsedTwiceGetsBothParts) {
  ExpectAdjointIsRight([](Tape* t) {
    const Tape::Node left = Left(t);
    return t->Sum(t->Swish(left), t->Product(left, t->Weight(20, kColumns, kColumns)));
  });
}

TEST(Tape, MeanIntoLeavesRowsWithoutMembersAtZero) {
  const Eigen::VectorXd weights = Eigen::VectorXd::Ones(2);
  Tape tape(weights);
  const Tape::Node mean = tape.MeanInto(tape.Weight(0, 2, 1), {2, 2}, 3);
  EXPECT_EQ(tape.value(mean), (Features(3, 1) << 0, 0, 1).finished());
}

}  // namespace
}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/superfluous_springs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/swung_sheet.h"
#include "trainer/bodies/spring_net.h"
#include "trainer/bodies/start_system.h"

namespace physpring {
namespace {

// A sheet's net, and numbers of it that are not 0.
struct Sheet {
  Recording recording = SwungSheet(5);
  SmoothlyFitted fit = Fit();

  // Springs of this length and longer ones get exp(softer) times their stiffness.
  void Soften(double length, double softer) {
    const Parameters& factors = fit.body.factors();
    std::vector<bool> soft(static_cast<std::size_t>(factors.classes().count), false);
    for (int e = 0; e < factors.base().spring_count(); ++e) {
      if (factors.base().rest_length[e] >= length) soft[factors.classes().of_spring[e]] = true;
    }
    for (int i = 0; i < factors.classes().count; ++i) {
      if (soft[i]) fit.x[factors.first_class() + i] += softer;
    }
  }
  // As a fit would make classes of which springs of this length and longer ones carry nothing.
  void CarryUpTo(double length) {
    const Parameters& factors = fit.body.factors();
    const auto classes = static_cast<std::size_t>(factors.classes().count);
    std::vector<double> carrying(classes, 0), count(classes, 0);
    for (int e = 0; e < factors.base().spring_count(); ++e) {
      const auto one = static_cast<std::size_t>(factors.classes().of_spring[e]);
      if (factors.base().rest_length[e] < length) carrying[one] += 1;
      count[one] += 1;
    }
    fit.x.setZero();
    for (std::size_t i = 0; i < classes; ++i) {
      fit.x[factors.first_class() + static_cast<int>(i)] =
          std::log(std::max(0.01, carrying[i] / count[i]));
    }
  }
  void MakeIrregular() {
    recording = Jittered(recording, 0.3);
    fit = Fit();
  }
  std::optional<SmoothlyFitted> Without() const {
    return WithoutSuperfluousSprings(fit, recording, SpringNet());
  }

 private:
  SmoothlyFitted Fit() const {
    SpringMassSystem start =
        MakeStartSystem(recording, {.max_neighbours = 8, .controller_max_neighbours = 8});
    start.dashpot = 1e-3 * start.stiffness;
    const SmoothBody body(start, recording, SpringNet(), {.most_rate = 1e6});
    Eigen::VectorXd x = Eigen::VectorXd::Zero(body.size());
    for (int i = 0; i < body.factors().first_class(); ++i) x[i] = 0.1 + 0.05 * i;
    x.segment(body.factors().first_mode(), 3).setConstant(0.2);
    return {body, x};
  }
};

TEST(SuperfluousSprings, AreNoneWhereAllCarry) {
  Sheet sheet;
  EXPECT_FALSE(sheet.Without());
  sheet.Soften(1.9 * kSheetSpacing, std::log(0.2));
  EXPECT_FALSE(sheet.Without());
}

TEST(SuperfluousSprings, AreLeftOutAndTheRestStaysAsItIs) {
  constexpr double kLongest = 2.1 * kSheetSpacing;
  Sheet sheet;
  const SpringMassSystem dense = sheet.fit.System(), expected = OnlyShorter(dense, kLongest);
  ASSERT_LT(expected.spring_count(), dense.spring_count());
  sheet.Soften(kLongest, std::log(0.01));
  const auto sparse = sheet.Without();
  ASSERT_TRUE(sparse);
  const SpringMassSystem system = sparse->System();
  ASSERT_EQ(system.springs, expected.springs);
  EXPECT_EQ(system.rest_length, expected.rest_length);
  for (int e = 0; e < system.spring_count(); ++e) {
    EXPECT_NEAR(system.stiffness[e] / expected.stiffness[e], 1, 0.05);
    EXPECT_NEAR(system.dashpot[e] / expected.dashpot[e], 1, 0.05);
  }
  EXPECT_EQ(system.drag, expected.drag);
  EXPECT_EQ(system.contact, expected.contact);
}

// In an irregular mesh the object's springs end within a class.
TEST(SuperfluousSprings, TellWhereSpringsOfAnIrregularMeshEnd) {
  Sheet sheet;
  sheet.MakeIrregular();
  const SpringMassSystem dense = sheet.fit.System();
  ASSERT_TRUE(sheet.fit.body.factors().classes().irregular);
  std::vector<double> lengths(dense.rest_length.begin(), dense.rest_length.end());
  std::sort(lengths.begin(), lengths.end());
  const std::size_t most = lengths.size() * 3 / 4;
  for (std::size_t end : {most, most + 1}) {
    Sheet sparse = sheet;
    int rounds = 0;
    for (;; ++rounds) {
      sparse.CarryUpTo(lengths[end]);
      const auto next = sparse.Without();
      if (!next) break;
      sparse.fit = *next;
    }
    EXPECT_EQ(sparse.fit.System().springs, OnlyShorter(dense, lengths[end]).springs);
    EXPECT_LE(rounds, 3);
  }
}

// Of its springs beside the longest, a particle in the sheet's middle has none.
TEST(SuperfluousSprings, StayWhereNodesWouldHangOnTooFew) {
  Sheet sheet;
  const double longest = sheet.fit.body.factors().base().rest_length.maxCoeff();
  sheet.Soften(0, std::log(0.01));
  sheet.Soften(longest - 1e-6, -std::log(0.01));
  EXPECT_FALSE(sheet.Without());
}

}  // namespace
}  // namespace physpring

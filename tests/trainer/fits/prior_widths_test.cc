// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/prior_widths.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>

#include "tests/support/swung_sheet.h"
#include "trainer/bodies/spring_net.h"
#include "trainer/bodies/start_system.h"

namespace physpring {
namespace {

constexpr double kNoise = 1e-3;  // m

// The residuals of a sheet's body are linear in its numbers; those of the truth leave noise.
class LinearSheet {
 public:
  LinearSheet() {
    SpringMassSystem start =
        MakeStartSystem(recording_, {.max_neighbours = 12, .controller_max_neighbours = 8});
    start.dashpot = 1e-3 * start.stiffness;
    body_.emplace(start, recording_, SpringNet(),
                  SmoothBody::Options{.most_rate = 1e6, .hands_apart = true});
  }
  const Parameters& factors() const { return body_->factors(); }
  Eigen::VectorXd Zero() const { return Eigen::VectorXd::Zero(body_->size()); }

  // The widths that are found at the best fit with the prior of the body.
  SmoothBody::Widths WidthsFor(const Eigen::VectorXd& truth) const {
    constexpr int kResiduals = 4000;
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    const auto draw = [&](int rows, Eigen::Index columns) {
      Eigen::MatrixXd drawn(rows, columns);
      for (double& value : drawn.reshaped()) value = normal(random);
      return drawn;
    };
    // a residual tells any number to about 20 %
    const Eigen::MatrixXd slope =
        5 * kNoise / std::sqrt(static_cast<double>(kResiduals)) * draw(kResiduals, truth.size());
    const Eigen::VectorXd noise = kNoise * draw(kResiduals, 1);
    const Eigen::MatrixXd normal_matrix = slope.transpose() * slope / (kNoise * kNoise);
    const Eigen::VectorXd seen = slope.transpose() * (slope * truth - noise) / (kNoise * kNoise);
    const Eigen::VectorXd x = (normal_matrix + body_->Precision(truth)).ldlt().solve(seen);
    return MostProbableWidths({*body_, x}, {slope * (x - truth) + noise, slope});
  }

 private:
  Recording recording_ = SwungSheet(5);
  std::optional<SmoothBody> body_;
};

TEST(MostProbableWidths, AreNarrowWhereAllIsAlike) {
  const LinearSheet sheet;
  Eigen::VectorXd truth = sheet.Zero();
  truth.head(4) << 0.5, 0.5, -0.3, -0.3;
  const SmoothBody::Widths widths = sheet.WidthsFor(truth), before;
  EXPECT_LT(widths.classes, 0.3);
  EXPECT_LT(widths.field, before.field);
  EXPECT_LT(widths.hands, 0.5);
}

TEST(MostProbableWidths, AreAsWideAsNumbersDiffer) {
  const LinearSheet sheet;
  const SpringClasses& classes = sheet.factors().classes();
  ASSERT_GE(classes.lengths, 3);
  Eigen::VectorXd differing = sheet.Zero();
  for (int i = 0; i < classes.lengths; ++i) {
    differing[sheet.factors().first_class() + i] = i % 2 == 0 ? 1.5 : -1.5;
  }
  EXPECT_GE(sheet.WidthsFor(differing).classes, 1);

  Eigen::VectorXd of_hands = sheet.Zero();
  of_hands[1] = 2;   // stiffness of the controllers' springs, the object's being 0
  of_hands[3] = -2;  // loss time
  EXPECT_GE(sheet.WidthsFor(of_hands).hands, 0.5);

  Eigen::VectorXd rough = sheet.Zero();
  rough.segment(sheet.factors().first_mode() + 3, 5).setConstant(0.8);
  EXPECT_GT(sheet.WidthsFor(rough).field, sheet.WidthsFor(sheet.Zero()).field);
}

}  // namespace
}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
// Masses other than declared: a payload added at a place of the body (its patch, see
// body_coordinate.h), and a smooth redistribution along the body that keeps the total:
//   m_i' = M m_i (1 + f(s_i)) / sum_j m_j (1 + f(s_j)) + payload w_i
#include "twin/effects/body_coordinate.h"
#include "twin/effects/effect.h"

namespace physpring {
namespace {

constexpr int kMassKnots = 4;

// 1 + f of each node.
Eigen::VectorXd Field(const SpringMassSystem& system, const Eigen::VectorXd& values) {
  const Eigen::MatrixXd knots = KnotWeights(BodyCoordinate(system), kMassKnots);
  return (knots * values.tail(kMassKnots)).head(system.node_count()).array() + 1;
}

class MassDistribution : public Effect {
 public:
  std::string name() const override { return "mass_distribution"; }
  EffectPicture Picture(const Eigen::VectorXd& values, const Setting& before) const override {
    constexpr double kNone = 0.01;  // of the body's mass
    EffectPicture picture;
    picture.lacks = "another spread of its mass along the body";
    if (values[0] > kNone * before.system.mass.sum()) {
      picture.lacks = "an extra mass";
      picture.amount = 0;
      picture.places = {{values.segment<3>(1), {}}};
    }
    picture.profiles = {{"change of density", 4, kMassKnots}};
    return picture;
  }
  std::vector<EffectParameter> parameters() const override {
    return {{"mass_kg", 0, 100, 1, 1, EffectParameter::Spacing::kLogarithmic},
            {"place_x_m", -100, 100, 0.05},
            {"place_y_m", -100, 100, 0.05},
            {"place_z_m", -100, 100, 0.05},
            {"relative_density_change", -0.9, 10, 0.3, kMassKnots}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem& system) const override {
    constexpr int kPlaces = 10;
    std::vector<Eigen::VectorXd> starts;
    for (int node : SpreadNodes(system, kPlaces)) {
      for (double part : {0.1, 0.5}) {
        Eigen::VectorXd start = Eigen::VectorXd::Zero(4 + kMassKnots);
        start[0] = part * system.mass.sum();
        start.segment<3>(1) = system.position.col(node);
        starts.push_back(start);
      }
    }
    return starts;
  }

  void Change(const Eigen::VectorXd& values, Setting* setting) const override {
    SpringMassSystem& system = setting->system;
    if (!values.tail(kMassKnots).isZero()) {
      const double total = system.mass.sum();
      const Eigen::VectorXd weighted = system.mass.cwiseProduct(Field(system, values));
      system.mass = total / weighted.sum() * weighted;
    }
    if (values[0] != 0) system.mass += values[0] * PatchWeights(system, values.segment<3>(1));
  }

  void ChangeAdjoint(const Eigen::VectorXd& values, const Setting& before, SystemGradient* gradient,
                     Eigen::VectorXd* values_bar) const override {
    const SpringMassSystem& system = before.system;
    const Eigen::VectorXd mass_bar = gradient->mass;
    // forward: m' = .. + payload w
    const Eigen::VectorXd weights = PatchWeights(system, values.segment<3>(1));
    (*values_bar)[0] += mass_bar.dot(weights);
    PatchWeightsAdjoint(system, values.segment<3>(1), weights, values[0] * mass_bar,
                        values_bar->segment<3>(1));
    // forward: m' = M y / sum y, y = m (1 + f)
    const Eigen::VectorXd field = Field(system, values);
    const Eigen::VectorXd y = system.mass.cwiseProduct(field);
    const double total = system.mass.sum(), sum = y.sum(), mean = mass_bar.dot(y) / sum;
    const Eigen::VectorXd y_bar = total / sum * (mass_bar.array() - mean);
    gradient->mass = y_bar.cwiseProduct(field);
    gradient->mass.array() += mean;  // by M
    const Eigen::MatrixXd knots =
        KnotWeights(BodyCoordinate(system).head(system.node_count()), kMassKnots);
    values_bar->tail(kMassKnots) += knots.transpose() * y_bar.cwiseProduct(system.mass);
  }

  EffectMjcf Mjcf(const Eigen::VectorXd&, const SpringMassSystem&) const override {
    return {EffectMjcf::Carrier::kSetting, {}, {}, ""};
  }
};

}  // namespace

std::unique_ptr<Effect> MakeMassDistribution() { return std::make_unique<MassDistribution>(); }

}  // namespace physpring

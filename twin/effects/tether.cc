// SPDX-License-Identifier: Apache-2.0
// An undeclared attachment: a spring and dashpot from a patch of the body to a point of the world.
// With the patch's weights w (body_coordinate.h), y = sum w x, f_i = w_i (K (anchor - y) - C
// y_dot).
#include "twin/effects/body_coordinate.h"
#include "twin/effects/effect.h"

namespace physpring {
namespace {

class TetherForce : public EffectForce {
 public:
  TetherForce(const SpringMassSystem& system, const Eigen::VectorXd& values)
      : system_(system), values_(values), weights_(PatchWeights(system, values.segment<3>(2))) {}

  void Add(const Instant& instant, Eigen::Ref<Eigen::VectorXd>, Points* force) const override {
    force->leftCols(weights_.size()) += Pull(instant) * weights_.transpose();
  }

  void AddAdjoint(const Instant& instant, const Eigen::Ref<const Eigen::VectorXd>&,
                  const Points& force_bar, Eigen::Ref<Eigen::VectorXd>,
                  InstantGradient* gradient) const override {
    const Eigen::Index nodes = weights_.size();
    const auto x = instant.x.leftCols(nodes), v = instant.v.leftCols(nodes);
    // forward: f_i = w_i F:  F_bar = sum w f_bar
    const Eigen::Vector3d pull_bar = force_bar.leftCols(nodes) * weights_;
    Eigen::VectorXd weights_bar = force_bar.leftCols(nodes).transpose() * Pull(instant);
    // forward: F = K (anchor - y) - C y_dot
    gradient->values[0] += pull_bar.dot(values_.tail<3>() - x * weights_);
    gradient->values[1] -= pull_bar.dot(v * weights_);
    gradient->values.tail<3>() += values_[0] * pull_bar;
    gradient->x.leftCols(nodes) -= values_[0] * pull_bar * weights_.transpose();
    gradient->v.leftCols(nodes) -= values_[1] * pull_bar * weights_.transpose();
    weights_bar -=
        values_[0] * (x.transpose() * pull_bar) + values_[1] * (v.transpose() * pull_bar);
    PatchWeightsAdjoint(system_, values_.segment<3>(2), weights_, weights_bar,
                        gradient->values.segment<3>(2));
  }

 private:
  Eigen::Vector3d Pull(const Instant& instant) const {
    const Eigen::Index nodes = weights_.size();
    return values_[0] * (values_.tail<3>() - instant.x.leftCols(nodes) * weights_) -
           values_[1] * (instant.v.leftCols(nodes) * weights_);
  }

  const SpringMassSystem& system_;
  Eigen::VectorXd values_, weights_;
};

class Tether : public Effect {
 public:
  std::string name() const override { return "tether"; }
  EffectPicture Picture(const Eigen::VectorXd& values, const Setting&) const override {
    EffectPicture picture;
    picture.lacks = "a pull towards a fixed point, as of a spring";
    picture.amount = 0;
    picture.places = {{values.segment<3>(2), values.tail<3>()}};
    return picture;
  }
  std::vector<EffectParameter> parameters() const override {
    return {{"stiffness_n_per_m", 0, 1e4, 1, 1, EffectParameter::Spacing::kLogarithmic},
            {"damping_n_s_per_m", 0, 100, 0.1},
            {"place_x_m", -100, 100, 0.05},
            {"place_y_m", -100, 100, 0.05},
            {"place_z_m", -100, 100, 0.05},
            {"anchor_x_m", -100, 100, 0.05},
            {"anchor_y_m", -100, 100, 0.05},
            {"anchor_z_m", -100, 100, 0.05}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem& system) const override {
    constexpr int kPlaces = 12;
    std::vector<Eigen::VectorXd> starts;
    for (int node : SpreadNodes(system, kPlaces)) {
      Eigen::VectorXd start(8);
      start << 1, 0, system.position.col(node), system.position.col(node);
      starts.push_back(start);
    }
    return starts;
  }
  std::unique_ptr<EffectForce> MakeForce(const SpringMassSystem& system,
                                         const Eigen::VectorXd& values) const override {
    return std::make_unique<TetherForce>(system, values);
  }
  void Stiffen(const Eigen::VectorXd& values, SpringMassSystem* bound) const override {
    // K w w^T is at most K w_i sum(w) at each node: a spring to a controller, or to any other node
    const Eigen::VectorXd weights = PatchWeights(*bound, values.segment<3>(2));
    Eigen::Index node = 0;
    weights.maxCoeff(&node);
    const Eigen::Index e = bound->spring_count() + 1;
    bound->springs.push_back({static_cast<int>(node), node == 0 ? 1 : 0});
    bound->stiffness.conservativeResize(e);
    bound->dashpot.conservativeResize(e);
    bound->rest_length.conservativeResize(e);
    bound->stiffness[e - 1] = values[0] * weights[node];
    bound->dashpot[e - 1] = values[1] * weights[node];
    bound->rest_length[e - 1] = 1;
  }
  EffectMjcf Mjcf(const Eigen::VectorXd& values, const SpringMassSystem& system) const override {
    EffectMjcf mjcf{EffectMjcf::Carrier::kAnchor,
                    {},
                    {},
                    "each node of the patch has a spring of its own to the anchor"};
    const Eigen::VectorXd weights = PatchWeights(system, values.segment<3>(2));
    for (int i = 0; i < static_cast<int>(weights.size()); ++i) {
      if (weights[i] < 1e-3) continue;
      mjcf.anchors.push_back({i, values.tail<3>(), values[0] * weights[i], values[1] * weights[i]});
    }
    return mjcf;
  }
};

}  // namespace

std::unique_ptr<Effect> MakeTether() { return std::make_unique<Tether>(); }

}  // namespace physpring

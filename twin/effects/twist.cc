// SPDX-License-Identifier: Apache-2.0
// Twist of a rod. A rod's twist spreads along it much faster than it bends, so that it is the same
// everywhere: an angle of all by which the ends are turned against each other, over the length L.
// Nodes carry no frames; how the centre line's own turning changes that angle is known from their
// motion (Bergou et al., Discrete Elastic Rods, 2008, and Discrete Viscous Threads, 2010): at a
// triple with the edges p, q and the curvature binormal b = 2 p x q / (|p| |q| + p . q)
//   angle_dot = sum b . (p_dot / (2 |p|) + q_dot / (2 |q|))
// if the hands do not roll about the rod's ends. The angle, an internal variable that starts at 0,
// and the turn at the start give the torque T = GJ (turn + angle) / L, and edges feel the forces
// -T b / (2 |p|) and -T b / (2 |q|): torques on a straight rod are none, a bent one leaves its
// plane.
#include "twin/effects/bend_effect.h"

namespace physpring {
namespace {

using Vector = Eigen::Vector3d;

// Edges that fold back onto each other have no binormal.
constexpr double kFolded = 1e-3;

// The geometry of a triple. p_slope and q_slope: derivatives of the angle by the edges, 1/m.
struct Twist {
  Vector p, q, binormal, p_slope, q_slope;
  double p_length, q_length, scale;  // scale: |p| |q| + p . q
  bool folded;

  Twist(const Points& x, const BendingTriple& triple)
      : p(x.col(triple.b) - x.col(triple.a)),
        q(x.col(triple.c) - x.col(triple.b)),
        p_length(p.norm()),
        q_length(q.norm()),
        scale(p_length * q_length + p.dot(q)),
        folded(!(scale > kFolded * p_length * q_length)) {
    if (folded) return;
    binormal = 2 / scale * p.cross(q);
    p_slope = binormal / (2 * p_length);
    q_slope = binormal / (2 * q_length);
  }

  // d loss / d p and q, from those by the slopes.
  void Adjoint(const Vector& p_slope_bar, const Vector& q_slope_bar, Vector* p_bar,
               Vector* q_bar) const {
    // forward: slope = binormal / (2 length)
    const Vector binormal_bar = p_slope_bar / (2 * p_length) + q_slope_bar / (2 * q_length);
    *p_bar = -p_slope_bar.dot(p_slope) / (p_length * p_length) * p;
    *q_bar = -q_slope_bar.dot(q_slope) / (q_length * q_length) * q;
    // forward: binormal = 2 p x q / scale
    const Vector cross_bar = 2 / scale * binormal_bar;
    *p_bar += q.cross(cross_bar);
    *q_bar += cross_bar.cross(p);
    // forward: scale = |p| |q| + p . q
    const double scale_bar = -binormal_bar.dot(binormal) / scale;
    *p_bar += scale_bar * (q_length / p_length * p + q);
    *q_bar += scale_bar * (p_length / q_length * q + p);
  }
};

// Adds what edges get to their nodes.
void AddToNodes(const BendingTriple& triple, const Vector& p, const Vector& q, Points* nodes) {
  nodes->col(triple.a) -= p;
  nodes->col(triple.b) += p - q;
  nodes->col(triple.c) += q;
}

class TwistForce : public EffectForce {
 public:
  TwistForce(const SpringMassSystem& system, const Eigen::VectorXd& values)
      : values_(values), triples_(FindBendingTriples(system)) {
    for (const BendingTriple& triple : triples_) length_ += triple.length;
  }

  int internal_size() const override { return 1; }

  void Add(const Instant& instant, Eigen::Ref<Eigen::VectorXd> internal,
           Points* force) const override {
    const Points slope = Slope(instant.x);
    internal[0] += instant.step * slope.cwiseProduct(instant.v).sum();
    *force -= Torque(internal[0]) * slope;
  }

  void AddAdjoint(const Instant& instant, const Eigen::Ref<const Eigen::VectorXd>& internal,
                  const Points& force_bar, Eigen::Ref<Eigen::VectorXd> internal_bar,
                  InstantGradient* gradient) const override {
    const Points slope = Slope(instant.x);
    const double angle = internal[0] + instant.step * slope.cwiseProduct(instant.v).sum();
    // forward: force = -torque slope
    const double torque_bar = -force_bar.cwiseProduct(slope).sum();
    // forward: torque = GJ (turn + angle) / L
    gradient->values[0] += torque_bar * (values_[1] + angle) / length_;
    gradient->values[1] += torque_bar * values_[0] / length_;
    internal_bar[0] += torque_bar * values_[0] / length_;
    // forward: angle += h slope . v
    const double rate_bar = instant.step * internal_bar[0];
    gradient->v += rate_bar * slope;
    const Points slope_bar = rate_bar * instant.v - Torque(angle) * force_bar;
    for (const BendingTriple& triple : triples_) {
      const Twist twist(instant.x, triple);
      if (twist.folded) continue;
      Vector p_bar, q_bar;
      twist.Adjoint(slope_bar.col(triple.b) - slope_bar.col(triple.a),
                    slope_bar.col(triple.c) - slope_bar.col(triple.b), &p_bar, &q_bar);
      AddToNodes(triple, p_bar, q_bar, &gradient->x);
    }
  }

 private:
  double Torque(double angle) const { return values_[0] * (values_[1] + angle) / length_; }

  // d angle / d x, 1/m, of all nodes and controllers.
  Points Slope(const Points& x) const {
    Points slope = Points::Zero(3, x.cols());
    for (const BendingTriple& triple : triples_) {
      const Twist twist(x, triple);
      if (!twist.folded) AddToNodes(triple, twist.p_slope, twist.q_slope, &slope);
    }
    return slope;
  }

  const Eigen::VectorXd values_;
  const std::vector<BendingTriple> triples_;
  double length_ = 0;  // L, m
};

class TwistEffect : public Effect {
 public:
  std::string name() const override { return "twist"; }
  EffectPicture Picture(const Eigen::VectorXd&, const Setting&) const override {
    EffectPicture picture;
    picture.lacks = "a resistance to twist";
    picture.amount = 0;
    picture.where = "along the whole body";
    return picture;
  }
  bool bends() const override { return true; }
  bool MayBeMissing(const BodyTraits& body) const override {
    return body.one_rod && Effect::MayBeMissing(body);
  }
  std::vector<EffectParameter> parameters() const override {
    return {{"torsional_rigidity_n_m2", 0, 1, 1, 1, EffectParameter::Spacing::kLogarithmic},
            {"turn_rad", -100, 100, 1}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem&) const override {
    std::vector<Eigen::VectorXd> starts;
    for (double rigidity : {1e-4, 1e-3}) {
      for (double turn : {-2.0, 0.0, 2.0}) starts.emplace_back(Eigen::Vector2d(rigidity, turn));
    }
    return starts;
  }
  RodPart rod_part() const override { return RodPart::kFitted; }
  Eigen::VectorXd StartOfRod(const RodTraits& rod) const override {
    return rod.joints ? Eigen::VectorXd()
                      : Eigen::VectorXd(Eigen::Vector2d(rod.flexural_rigidity, 0));
  }
  // Nothing but in one rod without joints: branches would need a twist each.
  std::unique_ptr<EffectForce> MakeForce(const SpringMassSystem& system,
                                         const Eigen::VectorXd& values) const override {
    if (!IsPlain(system.rod)) return nullptr;
    return std::make_unique<TwistForce>(system, values);
  }
  void Stiffen(const Eigen::VectorXd& values, SpringMassSystem* bound) const override {
    if (IsPlain(bound->rod)) StiffenLikeBending(values[0], 0, bound);
  }
  EffectMjcf Mjcf(const Eigen::VectorXd&, const SpringMassSystem&) const override {
    return {EffectMjcf::Carrier::kPlugin, {}, {}, "tendons do not twist"};
  }
};

}  // namespace

std::unique_ptr<Effect> MakeTwist() { return std::make_unique<TwistEffect>(); }

}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
#include "twin/effects/custom.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "twin/effects/spring_effect.h"

namespace physpring {
namespace {

constexpr double kLeastOfTerm = -0.9, kMostOfTerm = 4;  // c_x, of a term of the stretch

ActsOn ActsOnOf(const Eigen::VectorXd& values) {
  return static_cast<ActsOn>(std::clamp(std::lround(values[kCustomActsOn]), 0L, 4L));
}

InTime InTimeOf(const Eigen::VectorXd& values) {
  return static_cast<InTime>(std::clamp(std::lround(values[kCustomInTime]), 0L, 3L));
}

bool IsOfSprings(const Eigen::VectorXd& values) { return ActsOnOf(values) >= ActsOn::kStretch; }

// The course at a time, and its adjoint.
class TermCourse {
 public:
  TermCourse(const Eigen::VectorXd& values, double time)
      : periodic_(InTimeOf(values) == InTime::kPeriodic) {
    const auto a = values.segment<3>(kCustomA), b = values.segment<3>(kCustomB);
    switch (InTimeOf(values)) {
      case InTime::kConstant:
        first_ = 1;
        break;
      case InTime::kGrowing:
        first_ = time;
        break;
      case InTime::kSquare:
        first_ = time * time;
        break;
      case InTime::kPeriodic:
        first_ = std::sin(values[kCustomRate] * time);
        second_ = std::cos(values[kCustomRate] * time);
    }
    c_ = first_ * a + second_ * b;
    rate_slope_ = time * (second_ * a - first_ * b);
  }

  const Eigen::Vector3d& c() const { return c_; }

  // Adds to values_bar, (kCustomValues), what c_bar = d loss / d c makes of them.
  void AddAdjoint(const Eigen::Vector3d& c_bar, double* values_bar) const {
    if (periodic_) values_bar[kCustomRate] += rate_slope_.dot(c_bar);
    for (int j = 0; j < 3; ++j) {
      values_bar[kCustomA + j] += first_ * c_bar[j];
      values_bar[kCustomB + j] += second_ * c_bar[j];
    }
  }

 private:
  bool periodic_;
  double first_ = 0, second_ = 0;  // what a and b are multiplied by
  Eigen::Vector3d c_, rate_slope_;
};

class CustomForce : public EffectForce {
 public:
  CustomForce(const SpringMassSystem& system, const Eigen::VectorXd& values)
      : values_(values),
        acts_on_(ActsOnOf(values)),
        mass_(system.mass),
        middle_(system.position.leftCols(system.mass.size()).rowwise().mean()) {}

  void Add(const Instant& instant, Eigen::Ref<Eigen::VectorXd>, Points* force) const override {
    const Eigen::Vector3d c = TermCourse(values_, instant.time).c();
    force->leftCols(mass_.size()) += c.asDiagonal() * Of(instant) * mass_.asDiagonal();
  }

  void AddAdjoint(const Instant& instant, const Eigen::Ref<const Eigen::VectorXd>&,
                  const Points& force_bar, Eigen::Ref<Eigen::VectorXd>,
                  InstantGradient* gradient) const override {
    const Eigen::Index nodes = mass_.size();
    const TermCourse course(values_, instant.time);
    // forward: f = m c * s
    const Points s = Of(instant);
    const Points c_s_bar = force_bar.leftCols(nodes).cwiseProduct(s);
    const Points s_bar = course.c().asDiagonal() * force_bar.leftCols(nodes) * mass_.asDiagonal();
    gradient->parameters->mass += c_s_bar.transpose() * course.c();
    if (acts_on_ == ActsOn::kPlace) gradient->x.leftCols(nodes) += s_bar;
    if (acts_on_ == ActsOn::kVelocity) gradient->v.leftCols(nodes) += s_bar;
    course.AddAdjoint(c_s_bar * mass_, gradient->values.data());
  }

 private:
  // s, of each node, on which the term acts.
  Points Of(const Instant& instant) const {
    const Eigen::Index nodes = mass_.size();
    if (acts_on_ == ActsOn::kPlace) return instant.x.leftCols(nodes).colwise() - middle_;
    if (acts_on_ == ActsOn::kVelocity) return instant.v.leftCols(nodes);
    return Points::Ones(3, nodes);
  }

  Eigen::VectorXd values_;
  ActsOn acts_on_;
  Eigen::VectorXd mass_;
  Eigen::Vector3d middle_;  // m
};

template <class Real>
class CustomLaw {
 public:
  static constexpr int kValues = kCustomValues;
  static constexpr bool kHasInternal = false;

  CustomLaw(const Eigen::VectorXd& values, double time, double /*step*/)
      : course_(values, time), square_(ActsOnOf(values) == ActsOn::kSquare) {
    const double c = course_.c()[0];
    factor_ = static_cast<Real>(std::clamp(c, kLeastOfTerm, kMostOfTerm));
    const bool moves = c > kLeastOfTerm && c < kMostOfTerm;
    double slopes[kCustomValues] = {};
    if (moves) course_.AddAdjoint(Eigen::Vector3d::UnitX(), slopes);
    std::copy(slopes, slopes + kCustomValues, slope_);
  }

  Real Tension(const SpringMoment<Real>& s, Real*) const {
    const Real stretch = s.length - s.rest_length;
    const Real part = square_ ? stretch / s.rest_length : Real(1);
    return factor_ * s.stiffness * stretch * part;
  }
  void TensionAdjoint(const SpringMoment<Real>& s, Real, Real tension_bar, Real*,
                      SpringMoment<Real>* bar, Real* values_bar) const {
    const Real stretch = s.length - s.rest_length;
    const Real part = square_ ? stretch / s.rest_length : Real(1);
    const Real factor_bar = tension_bar * s.stiffness * stretch * part;
    for (int n = 0; n < kCustomValues; ++n) values_bar[n] += factor_bar * slope_[n];
    bar->stiffness += tension_bar * factor_ * stretch * part;
    // (l - L)^2 / L: 2 (l - L) / L with l, and -(l - L) (l + L) / L^2 with L
    const Real force_bar = tension_bar * factor_ * s.stiffness;
    bar->length += force_bar * (square_ ? 2 * part : Real(1));
    bar->rest_length -=
        force_bar * (square_ ? part * (s.length + s.rest_length) / s.rest_length : Real(1));
  }

 private:
  TermCourse course_;
  bool square_;
  Real factor_;                // c_x within its bounds
  Real slope_[kCustomValues];  // its derivatives with respect to the values
};

std::string InWords(const Eigen::Vector3d& v, bool scalar) {
  return scalar ? fmt::format("{:.3g}", v[0])
                : fmt::format("({:.3g}, {:.3g}, {:.3g})", v[0], v[1], v[2]);
}

// c(t) as a formula; the unit without its part of time.
std::string CourseInWords(const Eigen::VectorXd& values, bool scalar) {
  std::string a = InWords(values.segment<3>(kCustomA), scalar);
  switch (InTimeOf(values)) {
    case InTime::kConstant:
      return a;
    case InTime::kGrowing:
      return a + " t";
    case InTime::kSquare:
      return a + " t²";
    default:
      return fmt::format("({0} sin({2:.3g} t) + {1} cos({2:.3g} t))", a,
                         InWords(values.segment<3>(kCustomB), scalar), values[kCustomRate]);
  }
}

class Custom : public Effect {
 public:
  std::string name() const override { return kCustom; }
  EffectPicture Picture(const Eigen::VectorXd& values, const Setting& before) const override {
    EffectPicture picture;
    picture.formula = true;
    const std::string c = CourseInWords(values, IsOfSprings(values));
    const Eigen::Vector3d x0 = before.system.position.rowwise().mean();
    switch (ActsOnOf(values)) {
      case ActsOn::kNode:
        picture.lacks = fmt::format("an acceleration of {} m/s²", c);
        break;
      case ActsOn::kPlace:
        picture.lacks = fmt::format("an acceleration of {} (x - ({:.3g}, {:.3g}, {:.3g}) m) /s²", c,
                                    x0[0], x0[1], x0[2]);
        break;
      case ActsOn::kVelocity:
        picture.lacks = fmt::format("an acceleration of {} v /s", c);
        break;
      case ActsOn::kStretch:
        picture.lacks = fmt::format("an extra tension of {} k (l - L)", c);
        break;
      case ActsOn::kSquare:
        picture.lacks = fmt::format("an extra tension of {} k (l - L)² / L", c);
    }
    if (IsOfSprings(values)) picture.where = "in all springs";
    return picture;
  }
  // What a term is does not move: its scale is 0.
  std::vector<EffectParameter> parameters() const override {
    return {{.key = "acts_on", .low = 0, .high = 4, .scale = 0, .bounds_are_natural = true},
            {.key = "in_time", .low = 0, .high = 3, .scale = 0, .bounds_are_natural = true},
            {"rate_rad_per_s", 0, 200, 1},
            {"a_x", -1e3, 1e3, 1},
            {"a_y", -1e3, 1e3, 1},
            {"a_z", -1e3, 1e3, 1},
            {"b_x", -1e3, 1e3, 1},
            {"b_y", -1e3, 1e3, 1},
            {"b_z", -1e3, 1e3, 1}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem&) const override {
    Eigen::VectorXd start = Eigen::VectorXd::Zero(kCustomValues);
    start.head(3) << 0, static_cast<double>(InTime::kPeriodic), 6;
    return {start};
  }
  bool MayBeMissing(const BodyTraits&) const override { return false; }  // no list has it
  std::unique_ptr<EffectForce> MakeForce(const SpringMassSystem& system,
                                         const Eigen::VectorXd& values) const override {
    if (IsOfSprings(values)) return nullptr;
    return std::make_unique<CustomForce>(system, values);
  }
  std::unique_ptr<SpringTension> MakeTension(const Eigen::VectorXd& values) const override {
    if (!IsOfSprings(values)) return nullptr;
    return std::make_unique<LawTension<CustomLaw>>(values);
  }
  void Stiffen(const Eigen::VectorXd& values, SpringMassSystem* bound) const override {
    if (!IsOfSprings(values)) return;
    constexpr double kDuration = 10;  // s, of a long recording
    const double a = std::abs(values[kCustomA]), b = std::abs(values[kCustomB]);
    const double grown = InTimeOf(values) == InTime::kSquare     ? kDuration * kDuration * a
                         : InTimeOf(values) == InTime::kGrowing  ? kDuration * a
                         : InTimeOf(values) == InTime::kPeriodic ? a + b
                                                                 : a;
    bound->stiffness *= 1 + std::min(kMostOfTerm, grown);
  }
  EffectMjcf Mjcf(const Eigen::VectorXd&, const SpringMassSystem&) const override {
    return {EffectMjcf::Carrier::kPlugin, {}, {}, "MuJoCo has no law that is given by a formula"};
  }
};

}  // namespace

std::unique_ptr<Effect> MakeCustom() { return std::make_unique<Custom>(); }

}  // namespace physpring

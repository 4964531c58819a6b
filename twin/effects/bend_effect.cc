// SPDX-License-Identifier: Apache-2.0
#include "twin/effects/bend_effect.h"

#include <algorithm>

#include "twin/spring_law.h"

namespace physpring {
namespace {

// The part of a vector across an edge, divided by the edge's length: G(e, m) above. With m the
// velocity along the edge it is the rate of the tangent. 0 for an edge without direction.
struct Edge {
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
  double inverse = 0;

  Edge(const Points& x, int a, int b) {
    const Eigen::Vector3d e = x.col(b) - x.col(a);
    const double length = e.norm();
    if (length < kShortest) return;
    inverse = 1 / length;
    t = e * inverse;
  }
  Eigen::Vector3d Across(const Eigen::Vector3d& m) const { return inverse * (m - t.dot(m) * t); }

  // Adjoint of Across: adds to m_bar and e_bar.
  void AcrossAdjoint(const Eigen::Vector3d& m, const Eigen::Vector3d& across_bar,
                     Eigen::Vector3d* m_bar, Eigen::Vector3d* e_bar) const {
    *m_bar += Across(across_bar);
    *e_bar -= inverse * (t.dot(m) * Across(across_bar) + t.dot(across_bar) * Across(m) +
                         Across(m).dot(across_bar) * t);
  }
};

struct Bent {
  Edge p, q;
  Eigen::Vector3d u, w;  // velocities along the edges
  Bend bend;

  Bent(const Instant& instant, const BendingTriple& triple)
      : p(instant.x, triple.a, triple.b),
        q(instant.x, triple.b, triple.c),
        u(instant.v.col(triple.b) - instant.v.col(triple.a)),
        w(instant.v.col(triple.c) - instant.v.col(triple.b)),
        bend{q.t - p.t, q.Across(w) - p.Across(u), p.t} {}
};

// Nothing bends about a controller that holds nothing.
bool IsReleased(const Instant& instant, const BendingTriple& triple) {
  return instant.IsReleased(triple.a) || instant.IsReleased(triple.b) ||
         instant.IsReleased(triple.c);
}

}  // namespace

void AddBendForces(const std::vector<BendLaw>& laws, const Instant& instant,
                   Eigen::Ref<Eigen::VectorXd> internal, Points* force) {
  const std::vector<BendingTriple>& triples = laws[0].moment->triples();
  for (int i = 0; i < static_cast<int>(triples.size()); ++i) {
    const BendingTriple& triple = triples[i];
    if (IsReleased(instant, triple)) {
      for (const BendLaw& law : laws) {
        if (law.moment->has_internal()) internal.segment<3>(law.internal + 3 * i).setZero();
      }
      continue;
    }
    const Bent bent(instant, triple);
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();
    for (const BendLaw& law : laws) {
      double* z = law.moment->has_internal() ? internal.data() + law.internal + 3 * i : nullptr;
      Eigen::Vector3d variables = Eigen::Vector3d::Zero();
      if (z) variables = Eigen::Map<Eigen::Vector3d>(z);
      moment += law.moment->Moment(i, bent.bend, instant.step, &variables);
      if (z) Eigen::Map<Eigen::Vector3d>{z} = variables;
    }
    const Eigen::Vector3d on_p = bent.p.Across(moment), on_q = bent.q.Across(moment);
    force->col(triple.a) -= on_p;
    force->col(triple.b) += on_p + on_q;
    force->col(triple.c) -= on_q;
  }
}

void AddBendForcesAdjoint(const std::vector<BendLaw>& laws, const Instant& instant,
                          const Eigen::Ref<const Eigen::VectorXd>& internal,
                          const Points& force_bar, Eigen::Ref<Eigen::VectorXd> internal_bar,
                          Points* x_bar, Points* v_bar,
                          const std::vector<Eigen::VectorXd*>& values_bar) {
  using Vector = Eigen::Vector3d;
  const std::vector<BendingTriple>& triples = laws[0].moment->triples();
  for (int i = 0; i < static_cast<int>(triples.size()); ++i) {
    const auto [a, b, c, length, rest] = triples[i];
    if (IsReleased(instant, triples[i])) {
      for (const BendLaw& law : laws) {
        if (law.moment->has_internal()) internal_bar.segment<3>(law.internal + 3 * i).setZero();
      }
      continue;
    }
    const Bent bent(instant, triples[i]);
    // forward: f_a -= G(p, M), f_b += G(p, M) + G(q, M), f_c -= G(q, M)
    const Vector on_p_bar = force_bar.col(b) - force_bar.col(a);
    const Vector on_q_bar = force_bar.col(b) - force_bar.col(c);
    const Vector moment_bar = bent.p.Across(on_p_bar) + bent.q.Across(on_q_bar);
    Vector moment = Vector::Zero();
    Bend bar;
    for (std::size_t n = 0; n < laws.size(); ++n) {
      const bool has_internal = laws[n].moment->has_internal();
      const int at = laws[n].internal + 3 * i;
      Vector z = Vector::Zero(), z_bar = Vector::Zero();
      if (has_internal) {
        z = internal.segment<3>(at);
        z_bar = internal_bar.segment<3>(at);
      }
      Vector z_after = z;
      moment += laws[n].moment->Moment(i, bent.bend, instant.step, &z_after);
      laws[n].moment->MomentAdjoint(i, bent.bend, instant.step, z, moment_bar, &z_bar, &bar,
                                    values_bar[n]);
      if (has_internal) internal_bar.segment<3>(at) = z_bar;
    }
    Vector unused = Vector::Zero(), p_bar = Vector::Zero(), q_bar = Vector::Zero();
    bent.p.AcrossAdjoint(moment, on_p_bar, &unused, &p_bar);
    bent.q.AcrossAdjoint(moment, on_q_bar, &unused, &q_bar);

    // forward: rate = G(q, w) - G(p, u)
    Vector u_bar = Vector::Zero(), w_bar = Vector::Zero();
    bent.p.AcrossAdjoint(bent.u, -bar.rate, &u_bar, &p_bar);
    bent.q.AcrossAdjoint(bent.w, bar.rate, &w_bar, &q_bar);
    // forward: kappa = t - s, tangent = s
    p_bar += bent.p.Across(bar.tangent - bar.bend);
    q_bar += bent.q.Across(bar.bend);
    x_bar->col(a) -= p_bar;
    x_bar->col(b) += p_bar - q_bar;
    x_bar->col(c) += q_bar;
    v_bar->col(a) -= u_bar;
    v_bar->col(b) += u_bar - w_bar;
    v_bar->col(c) += w_bar;
  }
}

void StiffenLikeBending(double stiffness, double damping, SpringMassSystem* bound) {
  for (const auto& [a, b, c, length, rest] : FindBendingTriples(*bound)) {
    // kappa is at most (q - p) / shorter edge, and |q - p|^2 at most 2 |p|^2 + 2 |q|^2
    const double p = (bound->position.col(b) - bound->position.col(a)).norm();
    const double q = (bound->position.col(c) - bound->position.col(b)).norm();
    const double factor = 2 / (length * std::min(p, q) * std::min(p, q));
    for (const auto& [from, to] : {std::array<int, 2>{a, b}, std::array<int, 2>{b, c}}) {
      if (std::min(from, to) >= bound->node_count()) continue;
      bound->springs.push_back({from, to});
      const Eigen::Index e = bound->spring_count();
      const auto append = [e](double value, Eigen::VectorXd* values) {
        values->conservativeResize(e);
        (*values)[e - 1] = value;
      };
      append(factor * stiffness, &bound->stiffness);
      append(factor * damping, &bound->dashpot);
      append(length, &bound->rest_length);
    }
  }
}

}  // namespace physpring

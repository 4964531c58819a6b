// SPDX-License-Identifier: Apache-2.0
#include "twin/effects/twist_section.h"

#include <algorithm>
#include <utility>

namespace physpring {
namespace {

using Vector = Eigen::Vector3d;

// Edges that fold back onto each other have no binormal.
constexpr double kFolded = 1e-3;
// Branches that go on straight do not tell how a joint rolls: the sine of the angle, at most.
constexpr double kStraight = 1e-3;

// How a triple carries a frame along.
struct Carry {
  Vector p, q, binormal, p_slope, q_slope;  // slopes: derivatives of the angle by the edges, 1/m
  double p_length, q_length, scale;         // scale: |p| |q| + p . q
  bool folded;

  Carry(const Points& x, const BendingTriple& triple)
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

// How a joint rolls about the section's edge e.
struct Roll {
  const TwistJoint& at;
  Vector e;
  double length;       // |e|
  double squares = 0;  // sum |c|^2
  bool straight;

  Roll(const Points& x, const TwistJoint& joint)
      : at(joint), e(x.col(joint.head) - x.col(joint.tail)), length(e.norm()) {
    double all = 0;
    for (const int other : at.others) {
      const Vector d = x.col(other) - x.col(at.joint);
      squares += e.cross(d).squaredNorm();
      all += d.squaredNorm();
    }
    straight = !(squares > kStraight * kStraight * length * length * all);
  }

  // Adds sign times d angle / d x.
  void AddSlope(const Points& x, double sign, Points* slope) const {
    if (straight) return;
    const double share = sign * length / squares;
    for (const int other : at.others) {
      const Vector d = x.col(other) - x.col(at.joint), c = share * e.cross(d);
      slope->col(other) += c;
      slope->col(at.joint) -= c;
      const double along = d.dot(e) / (length * length);
      slope->col(at.head) -= along * c;
      slope->col(at.tail) += along * c;
    }
  }

  // Adds d loss / d x.
  void AddSlopeAdjoint(const Points& x, double sign, const Points& slope_bar, Points* x_bar) const {
    if (straight) return;
    // slope_bar . slope = sign |e| sum / squares, sum = sum of c . (w - along w_e), where w and w_e
    // are what slope_bar makes of d and e
    const Vector w_e = slope_bar.col(at.head) - slope_bar.col(at.tail);
    const auto part = [&](const Vector& d, const Vector& w) {
      return e.cross(d).dot(w - d.dot(e) / (length * length) * w_e);
    };
    double sum = 0;
    for (const int other : at.others) {
      sum += part(x.col(other) - x.col(at.joint), slope_bar.col(other) - slope_bar.col(at.joint));
    }
    const double sum_bar = sign * length / squares;
    const double squares_bar = -sum_bar * sum / squares;
    Vector e_bar = sign * sum / squares / length * e;  // of |e|
    for (const int other : at.others) {
      const Vector d = x.col(other) - x.col(at.joint), c = e.cross(d);
      const Vector w = slope_bar.col(other) - slope_bar.col(at.joint);
      const double along = d.dot(e) / (length * length);
      // forward: sum += c . (w - along w_e), squares += |c|^2
      const Vector c_bar = sum_bar * (w - along * w_e) + 2 * squares_bar * c;
      const double along_bar = -sum_bar * c.dot(w_e);
      // forward: c = e x d, along = d . e / |e|^2
      const Vector d_bar = c_bar.cross(e) + along_bar / (length * length) * e;
      e_bar += d.cross(c_bar) + along_bar / (length * length) * (d - 2 * along * e);
      x_bar->col(other) += d_bar;
      x_bar->col(at.joint) -= d_bar;
    }
    x_bar->col(at.head) += e_bar;
    x_bar->col(at.tail) -= e_bar;
  }
};

// A way between two ends that are kept from rolling.
struct TwistWay {
  std::vector<int> columns;
  std::optional<TwistJoint> first, last;
};

std::vector<TwistWay> TwistWays(const Rod& rod, int nodes) {
  const std::vector<std::vector<int>> neighbours = RodNeighbours(rod);
  const auto is_joint = [&](int column) { return column < nodes && neighbours[column].size() > 2; };
  const auto is_free = [&](int column) { return column < nodes && neighbours[column].size() <= 2; };
  const auto others = [&](int joint, int next) {
    std::vector<int> columns = neighbours[joint];
    std::erase(columns, next);
    return columns;
  };
  std::vector<TwistWay> ways;
  for (const std::vector<int>& way : RodWays(rod)) {
    if (is_free(way.front()) || is_free(way.back())) continue;
    TwistWay found{way, {}, {}};
    if (is_joint(way.front())) {
      found.first = TwistJoint{way[0], way[1], way[0], others(way[0], way[1])};
    }
    if (is_joint(way.back())) {
      const int before = way[way.size() - 2];
      found.last = TwistJoint{before, way.back(), way.back(), others(way.back(), before)};
    }
    ways.push_back(found);
  }
  return ways;
}

}  // namespace

TwistSection::TwistSection(std::vector<BendingTriple> triples) : triples_(std::move(triples)) {
  for (const BendingTriple& triple : triples_) {
    length_ += triple.length;
    columns_.insert(columns_.end(), {triple.a, triple.b, triple.c});
  }
}

TwistSection::TwistSection(const SpringMassSystem& system, const std::vector<int>& way,
                           std::optional<TwistJoint> first, std::optional<TwistJoint> last)
    : columns_(way), first_(std::move(first)), last_(std::move(last)) {
  const Points& x = system.position;
  const auto edge = [&](std::size_t i) { return (x.col(way[i + 1]) - x.col(way[i])).norm(); };
  for (std::size_t i = 0; i + 1 < way.size(); ++i) length_ += edge(i);
  for (std::size_t i = 0; i + 2 < way.size(); ++i) {
    if (std::min({way[i], way[i + 1], way[i + 2]}) >= system.node_count()) continue;
    triples_.push_back({way[i], way[i + 1], way[i + 2], (edge(i) + edge(i + 1)) / 2});
  }
}

Points TwistSection::Slope(const Points& x) const {
  Points slope = Points::Zero(3, x.cols());
  for (const BendingTriple& triple : triples_) {
    const Carry carry(x, triple);
    if (!carry.folded) AddToNodes(triple, carry.p_slope, carry.q_slope, &slope);
  }
  if (first_) Roll(x, *first_).AddSlope(x, -1, &slope);
  if (last_) Roll(x, *last_).AddSlope(x, 1, &slope);
  return slope;
}

void TwistSection::AddSlopeAdjoint(const Points& x, const Points& slope_bar, Points* x_bar) const {
  for (const BendingTriple& triple : triples_) {
    const Carry carry(x, triple);
    if (carry.folded) continue;
    Vector p_bar, q_bar;
    carry.Adjoint(slope_bar.col(triple.b) - slope_bar.col(triple.a),
                  slope_bar.col(triple.c) - slope_bar.col(triple.b), &p_bar, &q_bar);
    AddToNodes(triple, p_bar, q_bar, x_bar);
  }
  if (first_) Roll(x, *first_).AddSlopeAdjoint(x, -1, slope_bar, x_bar);
  if (last_) Roll(x, *last_).AddSlopeAdjoint(x, 1, slope_bar, x_bar);
}

std::vector<TwistSection> FindTwistSections(const SpringMassSystem& system) {
  std::vector<TwistSection> sections;
  if (IsPlain(system.rod)) {
    std::vector<BendingTriple> triples = FindBendingTriples(system);
    if (!triples.empty()) sections.emplace_back(std::move(triples));
    return sections;
  }
  for (const TwistWay& way : TwistWays(system.rod, system.node_count())) {
    sections.emplace_back(system, way.columns, way.first, way.last);
  }
  return sections;
}

bool HasTwistSections(const Rod& rod, int nodes) {
  return IsPlain(rod) || !TwistWays(rod, nodes).empty();
}

}  // namespace physpring

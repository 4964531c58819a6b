// SPDX-License-Identifier: Apache-2.0
// A part of a rod that is twisted as a whole, from one end that is kept from rolling to the next: a
// hand, or a joint, which rolls as its branches do. A branch with a free end is not twisted. Nodes
// carry no frames. How fast the ends turn against each other, about the rod, is known from motion:
//   angle_dot = roll of the last end - roll of the first end
//               + sum over triples of b . (p_dot / (2 |p|) + q_dot / (2 |q|))
// with a triple's edges p, q and curvature binormal b = 2 p x q / (|p| |q| + p . q): Bergou et al.,
// Discrete Elastic Rods, 2008, and Discrete Viscous Threads, 2010. A hand does not roll. A joint's
// roll about the edge e of the section, with the other branches' first edges d and c = e x d, is
// that of the rigid body which follows them best,
//   |e| sum (c . d_dot - (d . e) / |e|^2 c . e_dot) / sum |c|^2.
// Turned as a whole, a section keeps its angle.
#ifndef PHYSPRING_TWIN_EFFECTS_TWIST_SECTION_H_
#define PHYSPRING_TWIN_EFFECTS_TWIST_SECTION_H_

#include <optional>
#include <vector>

#include "twin/effects/bending_triples.h"
#include "twin/spring_mass_system.h"

namespace physpring {

// A joint at an end of a section: the edge of the section there goes from `tail` to `head`, one of
// which is the joint.
struct TwistJoint {
  int tail, head, joint;
  std::vector<int> others;  // the next columns on the other branches
};

class TwistSection {
 public:
  // Of a rod without joints: all of it, whatever holds its ends.
  explicit TwistSection(std::vector<BendingTriple> triples);
  // Along `way`, columns one after the other; ends without a joint are held.
  TwistSection(const SpringMassSystem& system, const std::vector<int>& way,
               std::optional<TwistJoint> first, std::optional<TwistJoint> last);

  double length() const { return length_; }  // m
  // Whether a hand holds one of its ends: how it is turned at the start is not known.
  bool is_held() const { return !first_ || !last_; }
  // The nodes and controllers along it.
  const std::vector<int>& columns() const { return columns_; }

  // d angle / d x, 1/m, of all nodes and controllers.
  Points Slope(const Points& x) const;
  // Adds d loss / d x, from that by the slope.
  void AddSlopeAdjoint(const Points& x, const Points& slope_bar, Points* x_bar) const;

 private:
  std::vector<int> columns_;
  std::vector<BendingTriple> triples_;
  std::optional<TwistJoint> first_, last_;
  double length_ = 0;
};

// Those of a system's rod, and whether a rod with so many nodes has any.
std::vector<TwistSection> FindTwistSections(const SpringMassSystem& system);
bool HasTwistSections(const Rod& rod, int nodes);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_EFFECTS_TWIST_SECTION_H_

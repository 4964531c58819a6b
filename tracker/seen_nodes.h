// SPDX-License-Identifier: Apache-2.0
// Which nodes do clouds show? A camera sees one side of an object, and no node behind it. Clouds
// themselves say which these are: nodes that points have belonged to of late. They are the weights
// of a mixture of distributions, learned as the clouds come, as in
//   Dempster, Laird and Rubin, Maximum likelihood from incomplete data via the EM algorithm,
//   J. Royal Statistical Society B 39 (1977), section 4.3.
// Without them, points at the edge of what is seen draw nodes from behind it, and the whole body
// slides.
#ifndef PHYSPRING_TRACKER_SEEN_NODES_H_
#define PHYSPRING_TRACKER_SEEN_NODES_H_

#include <Eigen/Core>

namespace physpring {

class SeenNodes {
 public:
  // The first nodes, `surface` of them, are seen alike at first, and the others not.
  SeenNodes(int nodes, int surface);

  // (nodes): 1 of nodes that are seen, little of others; never 0, since they may come into view.
  const Eigen::VectorXd& weight() const { return weight_; }

  // After a frame of `time` s. `count`: (nodes), of points that belong to the nodes.
  void Learn(const Eigen::VectorXd& count, double time);

 private:
  Eigen::VectorXd weight_, mean_;  // (nodes): `mean_` of the count of late; empty before any
};

}  // namespace physpring

#endif  // PHYSPRING_TRACKER_SEEN_NODES_H_

// SPDX-License-Identifier: Apache-2.0
#include "trainer/reduction/kmeans.h"

#include <limits>
#include <random>

#include "trainer/reduction/drawn_reduction.h"
#include "twin/neighbours.h"
#include "twin/uniform.h"

namespace physpring {
namespace {

// k-means++: each next centre is drawn with a probability in proportion to the squared distance
// from the ones there are.
Points SpreadCentres(const Points& points, int count, std::mt19937_64* random) {
  Points centres(3, count);
  centres.col(0) = points.col(static_cast<int>(Uniform(random) * points.cols()));
  Eigen::VectorXd squared =
      Eigen::VectorXd::Constant(points.cols(), std::numeric_limits<double>::infinity());
  for (int k = 1; k < count; ++k) {
    const Eigen::VectorXd to_last =
        (points.colwise() - centres.col(k - 1)).colwise().squaredNorm().transpose();
    squared = squared.cwiseMin(to_last);
    double left = Uniform(random) * squared.sum();
    int drawn = 0;
    while (drawn + 1 < points.cols() && (left -= squared[drawn]) >= 0) ++drawn;
    centres.col(k) = points.col(drawn);
  }
  return centres;
}

std::vector<int> NearestCentres(const Points& points, const Points& centres) {
  const NeighbourSearch search(centres);
  std::vector<int> nearest(points.cols());
  for (int i = 0; i < points.cols(); ++i) nearest[i] = search.Nearest(points.col(i), 1)[0].index;
  return nearest;
}

// Lloyd's iteration. A centre that loses all its points stays where it is.
Points MoveCentres(const Points& points, Points centres) {
  constexpr int kMostIterations = 100;
  std::vector<int> nearest;
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    const std::vector<int> before = std::move(nearest);
    nearest = NearestCentres(points, centres);
    if (nearest == before) break;
    Points sum = Points::Zero(3, centres.cols());
    Eigen::VectorXd count = Eigen::VectorXd::Zero(centres.cols());
    for (int i = 0; i < points.cols(); ++i) {
      sum.col(nearest[i]) += points.col(i);
      ++count[nearest[i]];
    }
    for (int k = 0; k < centres.cols(); ++k) {
      if (count[k] > 0) centres.col(k) = sum.col(k) / count[k];
    }
  }
  return centres;
}

}  // namespace

Assignment KMeansAssignment(const SpringMassSystem& system, int nodes, std::uint64_t seed) {
  const SpringGraph graph(system);
  const int count = ClusterBudget(graph, nodes);
  const Points points = system.position.leftCols(system.node_count());
  std::mt19937_64 random(seed);
  const Points centres = MoveCentres(points, SpreadCentres(points, count, &random));

  // the nodes nearest to the centres first, then any others
  const NeighbourSearch search(points);
  std::vector<int> order;
  std::vector<char> taken(points.cols(), 0);
  const auto take = [&](int node) {
    if (!taken[node]) order.push_back(node);
    taken[node] = 1;
  };
  for (int k = 0; k < count; ++k) take(search.Nearest(centres.col(k), 1)[0].index);
  for (int node : Shuffled(static_cast<int>(points.cols()), &random)) take(node);
  return GrowFromRoots(graph, FirstOfEachPartThenOthers(graph, order, count),
                       NearestCentres(points, centres));
}

namespace {

class KMeansReduction : public DrawnReduction {
 public:
  std::string name() const override { return "kmeans"; }
  std::string help() const override { return "near to each other in the rest positions"; }

 private:
  Assignment Draw(const SpringMassSystem& system, int nodes, std::uint64_t seed) const override {
    return KMeansAssignment(system, nodes, seed);
  }
};

}  // namespace

std::unique_ptr<Reduction> MakeKMeans() { return std::make_unique<KMeansReduction>(); }

}  // namespace physpring

// SPDX-License-Identifier: Apache-2.0
#include "registration/name_markers.h"

#include <limits>

namespace physpring {
namespace {

// The cheapest assignment of each row to a column of its own, of as many columns or more: along
// shortest augmenting paths, with prices of rows and columns.
std::vector<Eigen::Index> Assign(const Eigen::MatrixXd& cost) {
  const Eigen::Index rows = cost.rows(), columns = cost.cols();
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Eigen::VectorXd row_price = Eigen::VectorXd::Zero(rows + 1);
  Eigen::VectorXd column_price = Eigen::VectorXd::Zero(columns + 1);
  std::vector<Eigen::Index> owner(columns + 1, 0);  // 1 + row of each column; 0: none; [0]: the new
  for (Eigen::Index row = 1; row <= rows; ++row) {
    owner[0] = row;
    Eigen::Index at = 0;
    Eigen::VectorXd least = Eigen::VectorXd::Constant(columns + 1, kFar);
    std::vector<Eigen::Index> before(columns + 1, 0);
    std::vector<bool> visited(columns + 1, false);
    while (owner[at] != 0) {
      visited[at] = true;
      double step = kFar;
      Eigen::Index next = 0;
      for (Eigen::Index column = 1; column <= columns; ++column) {
        if (visited[column]) continue;
        const double reduced =
            cost(owner[at] - 1, column - 1) - row_price[owner[at]] - column_price[column];
        if (reduced < least[column]) {
          least[column] = reduced;
          before[column] = at;
        }
        if (least[column] < step) {
          step = least[column];
          next = column;
        }
      }
      for (Eigen::Index column = 0; column <= columns; ++column) {
        if (visited[column]) {
          row_price[owner[column]] += step;
          column_price[column] -= step;
        } else {
          least[column] -= step;
        }
      }
      at = next;
    }
    for (; at != 0; at = before[at]) owner[at] = owner[before[at]];
  }
  std::vector<Eigen::Index> column_of(rows, 0);
  for (Eigen::Index column = 1; column <= columns; ++column) {
    if (owner[column] != 0) column_of[owner[column] - 1] = column - 1;
  }
  return column_of;
}

// Markers and points that are near each other, directly or over others.
struct Group {
  std::vector<Eigen::Index> markers, points;
};

// Those of a marker, none of which was reached before.
Group GroupOf(Eigen::Index marker, const Points& markers, const Points& cloud, double reach,
              std::vector<bool>* marker_reached, std::vector<bool>* point_reached) {
  Group group{{marker}, {}};
  (*marker_reached)[marker] = true;
  for (std::size_t next = 0; next < group.markers.size(); ++next) {
    for (Eigen::Index j = 0; j < cloud.cols(); ++j) {
      const bool is_near = (cloud.col(j) - markers.col(group.markers[next])).norm() < reach;
      if ((*point_reached)[j] || !is_near) continue;
      (*point_reached)[j] = true;
      group.points.push_back(j);
      for (Eigen::Index i = 0; i < markers.cols(); ++i) {
        if ((*marker_reached)[i] || (markers.col(i) - cloud.col(j)).norm() >= reach) continue;
        (*marker_reached)[i] = true;
        group.markers.push_back(i);
      }
    }
  }
  return group;
}

void NameGroup(const Group& group, const Points& markers, const Points& cloud, double reach,
               std::vector<int>* named) {
  const auto count = static_cast<Eigen::Index>(group.markers.size());
  const auto points = static_cast<Eigen::Index>(group.points.size());
  // behind the points a place for each marker that is none of them
  Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(count, points + count, reach * reach);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < points; ++j) {
      cost(i, j) = (markers.col(group.markers[i]) - cloud.col(group.points[j])).squaredNorm();
    }
  }
  const std::vector<Eigen::Index> column_of = Assign(cost);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index column = column_of[i];
    if (column >= points || cost(i, column) >= reach * reach) continue;
    (*named)[group.markers[i]] = static_cast<int>(group.points[column]);
  }
}

}  // namespace

std::vector<int> NameMarkers(const Points& markers, const Points& cloud, double reach) {
  std::vector<int> named(static_cast<std::size_t>(markers.cols()), -1);
  std::vector<bool> marker_reached(named.size(), false);
  std::vector<bool> point_reached(static_cast<std::size_t>(cloud.cols()), false);
  for (Eigen::Index i = 0; i < markers.cols(); ++i) {
    if (marker_reached[i]) continue;
    const Group group = GroupOf(i, markers, cloud, reach, &marker_reached, &point_reached);
    NameGroup(group, markers, cloud, reach, &named);
  }
  return named;
}

}  // namespace physpring

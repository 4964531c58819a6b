// SPDX-License-Identifier: Apache-2.0
#include "splats/placement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "splats/settle.h"
#include "twin/neighbours.h"

namespace physpring {
namespace {

constexpr double kFarSpacings = 3;  // more is far
constexpr double kMostFar = 0.1;    // part of the splats
constexpr double kSameSize = 2;     // boxes differ by less

// Of numbers that may be reordered.
double Quantile(std::vector<double>* numbers, double part) {
  const auto place = static_cast<std::ptrdiff_t>(part * static_cast<double>(numbers->size() - 1));
  std::nth_element(numbers->begin(), numbers->begin() + place, numbers->end());
  return (*numbers)[static_cast<std::size_t>(place)];
}

}  // namespace

std::string BoxText(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  return fmt::format("{:.3g} {:.3g} {:.3g} to {:.3g} {:.3g} {:.3g} m", low.x(), low.y(), low.z(),
                     high.x(), high.y(), high.z());
}

Splats Place(const Splats& splats, const Placement& placement) {
  const bool is_there = placement.scale == 1 && placement.shift.isZero(0) &&
                        placement.turn.coeffs() == Eigen::Quaterniond::Identity().coeffs();
  if (is_there) return splats;
  const Eigen::Matrix3f turn = placement.turn.toRotationMatrix().cast<float>();
  const Eigen::Matrix3f f = static_cast<float>(placement.scale) * turn;
  PlacedSplats placed = AsStored(splats);
  placed.position = (f * placed.position).colwise() + placement.shift.cast<float>();
  placed.turn.resize(9, splats.count());
  for (int i = 0; i < splats.count(); ++i) {
    placed.SetCovariance(i, f * placed.Covariance(i) * f.transpose());
    placed.turn.col(i) = turn.reshaped();
  }
  return Settle(placed);
}

PlacementCheck CheckPlacement(const Splats& splats, const Points& nodes) {
  PlacementCheck check;
  check.spacing = nodes.cols() > 1 ? MedianSpacing(nodes) : 0;
  const NeighbourSearch search(nodes);
  std::vector<double> distances;
  int far = 0;
  for (int i = 0; i < splats.count(); ++i) {
    distances.push_back(search.Nearest(splats.position.col(i).cast<double>(), 1)[0].distance);
    far += distances.back() > kFarSpacings * check.spacing ? 1 : 0;
  }
  check.far = static_cast<double>(far) / splats.count();
  check.median = Quantile(&distances, 0.5);
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> along(splats.position.row(axis).begin(), splats.position.row(axis).end());
    check.low[axis] = Quantile(&along, 0.05);
    check.high[axis] = Quantile(&along, 0.95);
  }
  check.node_low = nodes.rowwise().minCoeff();
  check.node_high = nodes.rowwise().maxCoeff();
  const double half = (check.node_high - check.node_low).norm() / 2;
  for (int i = 0; i < splats.count(); ++i) {
    const double widest = std::exp(static_cast<double>(splats.log_scale.col(i).maxCoeff()));
    check.large += half > 0 && widest > half ? 1 : 0;
  }
  return check;
}

std::vector<std::string> WarningsOf(const PlacementCheck& check, const std::string& file) {
  std::vector<std::string> warnings;
  const double size = (check.high - check.low).norm();
  const double node_size = (check.node_high - check.node_low).norm();
  if (size > kSameSize * node_size || node_size > kSameSize * size) {
    warnings.push_back(
        fmt::format("{}: the splats are {:.3g} times as large as the twin ({}; the nodes {}): "
                    "another scale, or "
                    "more than the object; --scale",
                    file, size / node_size, BoxText(check.low, check.high),
                    BoxText(check.node_low, check.node_high)));
  }
  if (check.large > 0) {
    warnings.push_back(
        fmt::format("{}: {} splats are wider than half of the twin: cut them away in a viewer",
                    file, check.large));
  }
  if (check.far > kMostFar) {
    warnings.push_back(fmt::format(
        "{}: {:.0f} % of the splats are more than {:.0f} mm from all nodes, whose spacing is "
        "{:.1f} "
        "mm: another place ({}; the nodes {}), or not the object's; --position, --quaternion",
        file, 100 * check.far, 1e3 * kFarSpacings * check.spacing, 1e3 * check.spacing,
        BoxText(check.low, check.high), BoxText(check.node_low, check.node_high)));
  }
  return warnings;
}

}  // namespace physpring

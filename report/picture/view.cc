// SPDX-License-Identifier: Apache-2.0
#include "report/picture/view.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "report/picture/nice_step.h"

namespace physpring {
namespace {

// All that was seen, in all frames: 3 x many.
Points AllMeasured(const Recording& recording) {
  std::vector<Eigen::Vector3d> seen;
  for (const std::vector<Points>* frames : {&recording.points, &recording.controllers}) {
    for (const Points& frame : *frames) {
      for (Eigen::Index i = 0; i < frame.cols(); ++i) {
        if (frame.col(i).allFinite()) seen.emplace_back(frame.col(i));
      }
    }
  }
  return Eigen::Map<const Points>(seen.data()->data(), 3, static_cast<Eigen::Index>(seen.size()));
}

Eigen::Matrix3d Covariance(const Points& points) {
  const Points centred = points.colwise() - points.rowwise().mean();
  return centred * centred.transpose() / static_cast<double>(points.cols());
}

// The rows are the directions right, away and up.
Eigen::Matrix3d UprightAxes(const Eigen::Vector3d& gravity, const Eigen::Matrix3d& covariance) {
  const Eigen::Vector3d up =
      gravity.isZero() ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d(-gravity.normalized());
  const Eigen::Matrix3d horizontal = Eigen::Matrix3d::Identity() - up * up.transpose();
  const Eigen::Matrix3d spread = horizontal * covariance * horizontal;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  Eigen::Vector3d right = horizontal * solver.eigenvectors().col(2);
  if (right.norm() < 0.5) right = up.unitOrthogonal();  // no horizontal spread at all
  right.normalize();
  Eigen::Index largest = 0;
  right.cwiseAbs().maxCoeff(&largest);
  if (right[largest] < 0) right = -right;
  Eigen::Matrix3d axes;
  axes << right.transpose(), up.cross(right).transpose(), up.transpose();
  return axes;
}

// The camera stays low unless a view from higher up shows twice the area.
double ChooseElevation(const Eigen::Matrix3d& upright_covariance) {
  double best = 0, best_area = 0;
  for (double elevation : {0.25, 0.65, 1.1}) {
    Eigen::Matrix<double, 2, 3> projection;
    projection << 1, 0, 0, 0, std::sin(elevation), std::cos(elevation);
    const Eigen::Matrix2d spread = projection * upright_covariance * projection.transpose();
    const double area = std::sqrt(std::max(0.0, spread.determinant()));
    if (best_area > 0 && area < 2 * best_area) continue;
    best = elevation;
    best_area = area;
  }
  return best;
}

}  // namespace

View::View(const Recording& recording) {
  const Points measured = AllMeasured(recording);
  const Eigen::Matrix3d covariance = Covariance(measured);
  axes_ = UprightAxes(recording.gravity, covariance);
  elevation_ = ChooseElevation(axes_ * covariance * axes_.transpose());
  const Points upright = axes_ * measured;
  low_ = upright.rowwise().minCoeff();
  high_ = upright.rowwise().maxCoeff();
  const Eigen::Vector3d middle = (low_ + high_) / 2;
  low_ -= middle;
  high_ -= middle;
  centre_ = axes_.transpose() * middle;
}

Points View::ToUpright(const Points& points) const { return axes_ * (points.colwise() - centre_); }

Eigen::Matrix2Xd View::Project(const Points& upright) const {
  Eigen::Matrix2Xd picture(2, upright.cols());
  picture.row(0) = upright.row(0);
  picture.row(1) = std::sin(elevation_) * upright.row(1) + std::cos(elevation_) * upright.row(2);
  return picture;
}

Points GroundGrid(const Recording& recording, const View& view) {
  if (!recording.ground) return Points(3, 0);
  // the plane n . x = d, upright
  Points normal(3, 2);
  normal << Eigen::Vector3d::Zero(), recording.ground->head<3>();
  normal = view.ToUpright(normal);
  const Eigen::Vector3d n = normal.col(1) - normal.col(0);
  const double d = (*recording.ground)[3] + n.dot(normal.col(0));
  const double size = (view.high() - view.low()).maxCoeff();
  if (n.z() < 0.7 || d / n.z() < view.low().z() - size) return Points(3, 0);

  const double step = NiceStep(size / 5);
  const Eigen::Vector3d low = ((view.low() / step).array().floor() - 1) * step;
  const Eigen::Vector3d high = ((view.high() / step).array().ceil() + 1) * step;
  std::vector<Eigen::Vector3d> ends;
  const auto add_line = [&](double x1, double y1, double x2, double y2) {
    ends.emplace_back(x1, y1, (d - n.x() * x1 - n.y() * y1) / n.z());
    ends.emplace_back(x2, y2, (d - n.x() * x2 - n.y() * y2) / n.z());
  };
  for (double x = low.x(); x < high.x() + step / 2; x += step) add_line(x, low.y(), x, high.y());
  for (double y = low.y(); y < high.y() + step / 2; y += step) add_line(low.x(), y, high.x(), y);
  return Eigen::Map<const Points>(ends.data()->data(), 3, static_cast<Eigen::Index>(ends.size()));
}

}  // namespace physpring

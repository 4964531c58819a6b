// SPDX-License-Identifier: Apache-2.0
#include "rollout/mocap_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <random>

#include "twin/error.h"

namespace physpring {
namespace {

using Vectors = Eigen::Map<const Eigen::VectorXd>;

// Slope of a coordinate at a key with slopes `before` and `after` over `time_before`, `time_after`.
double KeySlope(double before, double after, double time_before, double time_after) {
  if (before * after <= 0) return 0;  // it turns or stands still
  const double weight_before = 2 * time_after + time_before;
  const double weight_after = time_after + 2 * time_before;
  return (weight_before + weight_after) / (weight_before / before + weight_after / after);
}

}  // namespace

MocapPath::MocapPath(const mjModel& model, const std::string& where) {
  const Eigen::Index bodies = model.nmocap, keys = model.nkey;
  if (bodies == 0)
    throw Error(where + ": has no mocap body (<body mocap=\"true\">) to move the flex");
  if (keys == 0) {
    throw Error(where + ": has no keyframes; <key time=.. mpos=..> tell how the mocap bodies move");
  }
  time_.assign(model.key_time, model.key_time + keys);
  for (std::size_t k = 1; k < time_.size(); ++k) {
    if (time_[k] <= time_[k - 1]) {
      throw Error(
          fmt::format("{}: key {} has time {} s, key {} before it {} s; times must increase", where,
                      k, time_[k], k - 1, time_[k - 1]));
    }
  }
  pose_.resize(7 * bodies, keys);
  for (Eigen::Index k = 0; k < keys; ++k) {
    pose_.col(k).head(3 * bodies) = Vectors(model.key_mpos + 3 * bodies * k, 3 * bodies);
    pose_.col(k).tail(4 * bodies) = Vectors(model.key_mquat + 4 * bodies * k, 4 * bodies);
    if (k == 0) continue;
    // q and -q are the same orientation: take the nearer one
    for (Eigen::Index body = 0; body < bodies; ++body) {
      const Eigen::Index row = 3 * bodies + 4 * body;
      if (pose_.block<4, 1>(row, k).dot(pose_.block<4, 1>(row, k - 1)) < 0) {
        pose_.block<4, 1>(row, k) *= -1;
      }
    }
  }
  ComputeSlopes();
}

void MocapPath::ComputeSlopes() {
  slope_ = Eigen::MatrixXd::Zero(pose_.rows(), pose_.cols());
  for (Eigen::Index k = 1; k + 1 < pose_.cols(); ++k) {
    const auto key = static_cast<std::size_t>(k);
    const double before = time_[key] - time_[key - 1], after = time_[key + 1] - time_[key];
    for (Eigen::Index i = 0; i < pose_.rows(); ++i) {
      slope_(i, k) = KeySlope((pose_(i, k) - pose_(i, k - 1)) / before,
                              (pose_(i, k + 1) - pose_(i, k)) / after, before, after);
    }
  }
}

void MocapPath::Vary(double distance, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> offset(-distance, distance);
  const Eigen::Index bodies = pose_.rows() / 7;
  for (Eigen::Index k = 1; k < pose_.cols(); ++k) {
    if (time_[static_cast<std::size_t>(k)] <= 0) continue;
    const double x = offset(random), y = offset(random), z = offset(random);
    for (Eigen::Index body = 0; body < bodies; ++body) {
      pose_.block<3, 1>(3 * body, k) += Eigen::Vector3d(x, y, z);
    }
  }
  ComputeSlopes();
}

void MocapPath::Place(double time, mjData* data) const {
  // key k before `time`, fraction s of the way to the next one
  const auto after = std::upper_bound(time_.begin(), time_.end(), time) - time_.begin();
  const Eigen::Index keys = pose_.cols();
  const Eigen::Index k =
      std::clamp<Eigen::Index>(after - 1, 0, std::max<Eigen::Index>(keys - 2, 0));
  const Eigen::Index next = std::min(k + 1, keys - 1);
  const double h = time_[static_cast<std::size_t>(next)] - time_[static_cast<std::size_t>(k)];
  const double s =
      h > 0 ? std::clamp((time - time_[static_cast<std::size_t>(k)]) / h, 0.0, 1.0) : 0;

  // cubic Hermite
  const double s2 = s * s, s3 = s2 * s;
  const Eigen::VectorXd pose =
      (2 * s3 - 3 * s2 + 1) * pose_.col(k) + (s3 - 2 * s2 + s) * h * slope_.col(k) +
      (3 * s2 - 2 * s3) * pose_.col(next) + (s3 - s2) * h * slope_.col(next);
  const Eigen::Index bodies = pose.size() / 7;
  std::copy_n(pose.data(), 3 * bodies, data->mocap_pos);
  std::copy_n(pose.data() + 3 * bodies, 4 * bodies, data->mocap_quat);
  for (Eigen::Index body = 0; body < bodies; ++body) mju_normalize4(data->mocap_quat + 4 * body);
}

}  // namespace physpring

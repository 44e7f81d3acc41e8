// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/realign/camera_pose.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace cyclorama::scan {
namespace {

constexpr std::size_t kMinObservations = 24;
constexpr int kMaxRounds = 30;
constexpr double kRobust_sigmas = 3.0;
// Prior deviation of the camera's centre: a tripod that is put back on its marks is not farther off.
constexpr double kCentre_m = 0.1;
constexpr double kClear_sigmas = 3.0;
constexpr double kPredictsBetter = 0.98;
constexpr double kArrived = 1e-12;

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

/// Returns two axes perpendicular to a ray.
Eigen::Matrix<double, 3, 2> across(const Eigen::Vector3d& ray) {
  Eigen::Matrix<double, 3, 2> axes;
  axes.col(0) = ray.unitOrthogonal();
  axes.col(1) = ray.cross(axes.col(0));
  return axes;
}

Eigen::Vector2d error_rad(const LocatedCamera& camera, const ReferenceObservation& observation) {
  const Eigen::Vector3d seen =
      camera.R_camera_eye * (observation.direction - observation.inverse_depth * camera.centre_m);
  return across(observation.ray).transpose() * (seen.normalized() - observation.ray);
}

double trimmed_rms(const LocatedCamera& camera, std::span<const ReferenceObservation> observations, bool of_left_out) {
  std::vector<double> squares;
  for (const ReferenceObservation& observation : observations) {
    if (observation.is_left_out == of_left_out) squares.push_back(0.5 * error_rad(camera, observation).squaredNorm());
  }
  if (squares.empty()) return 0.0;
  std::sort(squares.begin(), squares.end());
  squares.resize(squares.size() - squares.size() / 20);
  double sum = 0.0;
  for (const double square : squares) sum += square;
  return std::sqrt(sum / static_cast<double>(squares.size()));
}

/// Gauss-Newton with Cauchy weights. Returns nothing if the normal matrix is singular.
std::optional<LocatedCamera> solved(const LocatedCamera& planned, std::span<const ReferenceObservation> observations,
                                    bool with_centre) {
  LocatedCamera camera = planned;
  Matrix6 covariance = Matrix6::Zero();
  for (int round = 0; round < kMaxRounds; ++round) {
    Matrix6 normal = Matrix6::Zero();
    Vector6 right = Vector6::Zero();
    for (const ReferenceObservation& observation : observations) {
      if (observation.is_left_out) continue;
      const Eigen::Vector3d seen =
          camera.R_camera_eye * (observation.direction - observation.inverse_depth * camera.centre_m);
      const double length = seen.norm();
      if (!(length > 1e-9)) continue;
      const Eigen::Vector3d unit = seen / length;
      const Eigen::Matrix<double, 3, 2> axes = across(observation.ray);
      const Eigen::Vector2d error = axes.transpose() * (unit - observation.ray) / observation.sigma_rad;
      Eigen::Matrix<double, 3, 6> slope;
      slope.leftCols<3>() = -skew(seen);
      slope.rightCols<3>() = -observation.inverse_depth * camera.R_camera_eye;
      const Eigen::Matrix3d onto_unit = (Eigen::Matrix3d::Identity() - unit * unit.transpose()) / length;
      const Eigen::Matrix<double, 2, 6> jacobian = axes.transpose() * onto_unit * slope / observation.sigma_rad;
      const double weight = 1.0 / (1.0 + error.squaredNorm() / (kRobust_sigmas * kRobust_sigmas));
      normal += weight * jacobian.transpose() * jacobian;
      right -= weight * jacobian.transpose() * error;
    }
    const double prior = 1.0 / (kCentre_m * kCentre_m);
    for (int i = 3; i < 6; ++i) {
      normal(i, i) += prior;
      right(i) -= prior * (camera.centre_m - planned.centre_m)(i - 3);
    }
    Vector6 step = Vector6::Zero();
    if (with_centre) {
      const Eigen::LDLT<Matrix6> factor(normal);
      if (factor.info() != Eigen::Success || !factor.isPositive()) return std::nullopt;
      step = factor.solve(right);
      covariance = factor.solve(Matrix6::Identity());
    } else {
      const Eigen::LDLT<Eigen::Matrix3d> factor(normal.topLeftCorner<3, 3>());
      if (factor.info() != Eigen::Success || !factor.isPositive()) return std::nullopt;
      step.head<3>() = factor.solve(right.head<3>());
    }
    if (!step.allFinite()) return std::nullopt;
    const double angle = step.head<3>().norm();
    if (angle > 0.0) {
      camera.R_camera_eye = Eigen::AngleAxisd(angle, step.head<3>() / angle).toRotationMatrix() * camera.R_camera_eye;
    }
    camera.centre_m += step.tail<3>();
    if (step.squaredNorm() < kArrived * kArrived) break;
  }
  camera.is_elsewhere = with_centre;
  camera.centre_sigma_m = covariance.diagonal().tail<3>().cwiseMax(0.0).cwiseSqrt();
  camera.rms_rad = trimmed_rms(camera, observations, false);
  camera.heldout_rad = trimmed_rms(camera, observations, true);
  return camera;
}

}  // namespace

LocatedCamera planned_camera(const calibration::CalibratedTurntable& turntable, double angle_rad) {
  const std::array<double, 2> mount{turntable.pitch_rad, turntable.roll_rad};
  const std::array<double, 2> none{};
  const std::array<double, 2> offset{turntable.offset_m.x(), turntable.offset_m.y()};
  LocatedCamera camera;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
    Eigen::Vector3d turned;
    solve::to_camera(mount.data(), none.data(), angle_rad, unit.data(), 0.0, turned.data());
    camera.R_camera_eye.col(axis) = turned;
  }
  // With a zero direction, to_camera() returns the term of the camera's centre alone.
  const Eigen::Vector3d nowhere = Eigen::Vector3d::Zero();
  Eigen::Vector3d from_centre;
  solve::to_camera(mount.data(), offset.data(), angle_rad, nowhere.data(), 1.0, from_centre.data());
  camera.centre_m = -(camera.R_camera_eye.transpose() * from_centre);
  return camera;
}

Result<LocatedCamera> locate_camera(const LocatedCamera& planned, std::span<const ReferenceObservation> observations) {
  const auto used = static_cast<std::size_t>(std::count_if(
      observations.begin(), observations.end(), [](const ReferenceObservation& s) { return !s.is_left_out; }));
  if (used < kMinObservations) {
    return Error(ErrorCode::kBadData,
                 "the camera sees too little of the projectors that did not move, so its pose cannot be found");
  }
  const auto turned = solved(planned, observations, false);
  if (!turned) return Error(ErrorCode::kBadData, "what the camera sees of the other projectors lies on a line");
  // Starts at the fitted rotation, so that a large rotation of the camera does not mislead the fit.
  LocatedCamera start = *turned;
  start.centre_m = planned.centre_m;
  const auto moved = solved(start, observations, true);
  if (!moved) return *turned;
  const Eigen::Vector3d by = moved->centre_m - planned.centre_m;
  const bool is_clear = (by.cwiseAbs().array() > kClear_sigmas * moved->centre_sigma_m.array()).any();
  return is_clear && moved->heldout_rad < kPredictsBetter * turned->heldout_rad ? *moved : *turned;
}

}  // namespace cyclorama::scan

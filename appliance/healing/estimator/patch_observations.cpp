// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/estimator/patch_observations.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

namespace cyclorama::healing {
namespace {

constexpr double kTurn_rad = 1e-5;
constexpr double kShift_m = 1e-5;

std::optional<WallByCamera> wall_by_camera(const calibration::ShowCalibration& room,
                                           const calibration::ShowCamera& camera, const Eigen::Vector2d& slope,
                                           const Eigen::Vector3d& wall) {
  WallByCamera by;
  for (int axis = 0; axis < 6; ++axis) {
    calibration::PoseStep step = calibration::PoseStep::Zero();
    step[axis] = axis < 3 ? kTurn_rad : kShift_m;
    const auto T = calibration::stepped(camera.T_room_camera, step);
    const auto moved = hit_extended(room.wall, {{T.translation()}, T.rotation() * slope.homogeneous()});
    if (!moved) return std::nullopt;
    by.col(axis) = (moved->xyz - wall) / step[axis];
  }
  return by;
}

}  // namespace

std::optional<PatchObservation> patch_observation(const calibration::ShowCalibration& room, std::size_t camera,
                                                  std::size_t projector, const Eigen::Vector2d& shown,
                                                  const Eigen::Vector2d& seen, const Eigen::Matrix2d& covariance,
                                                  double min_sigma_px) {
  const calibration::ShowCamera& eye = room.cameras[camera];
  const calibration::ShowProjector& lamp = room.projectors[projector];
  const auto slope = calibration::slope_at(eye.lens, seen);
  const auto wall = calibration::wall_seen_at(room, eye, seen);
  if (!slope || !wall) return std::nullopt;
  const auto by = wall_by_camera(room, eye, *slope, *wall);
  if (!by) return std::nullopt;
  PatchObservation made{camera, projector, shown, seen, *wall, *by, {}};
  // Derivative of the projector's pixel with respect to the camera's pixel.
  const auto T = lamp.T_room_projector.inverse();
  const auto here = calibration::pixel_of(lamp.lens, (T * Point<frame::Room>{*wall}).xyz);
  Eigen::Matrix2d lies = Eigen::Matrix2d::Zero();
  for (int axis = 0; axis < 2; ++axis) {
    const auto beside = calibration::wall_seen_at(room, eye, seen + Eigen::Vector2d::Unit(axis));
    const auto there = beside ? calibration::pixel_of(lamp.lens, (T * Point<frame::Room>{*beside}).xyz) : std::nullopt;
    if (!here || !there) return std::nullopt;
    lies.col(axis) = *there - *here;
  }
  const Eigen::Matrix2d shown_covariance =
      lies * covariance * lies.transpose() + min_sigma_px * min_sigma_px * Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d root = shown_covariance.inverse().llt().matrixU();
  if (!root.allFinite()) return std::nullopt;
  made.root_information = root;
  return made;
}

std::vector<PatchObservation> patch_observations(const calibration::ShowCalibration& predicted,
                                                 const calibration::ShowCalibration& room, std::size_t camera,
                                                 int factor, std::span<const PatchShift> patches, double min_sigma_px) {
  std::vector<PatchObservation> made;
  for (const PatchShift& patch : patches) {
    if (patch.fit != PatchFit::kFits) continue;
    const auto projector = static_cast<std::size_t>(patch.projector);
    const auto wall = calibration::wall_seen_at(predicted, predicted.cameras[camera], patch.at * factor);
    if (!wall) continue;
    const calibration::ShowProjector& lamp = predicted.projectors[projector];
    const auto shown =
        calibration::pixel_of(lamp.lens, (lamp.T_room_projector.inverse() * Point<frame::Room>{*wall}).xyz);
    if (!shown) continue;
    const auto one = patch_observation(room, camera, projector, *shown, (patch.at + patch.shift) * factor,
                                       patch.covariance * factor * factor, min_sigma_px);
    if (one) made.push_back(*one);
  }
  return made;
}

double PixelMotion::rms_px(const calibration::PoseStep& step) const {
  if (by_step.rows() == 0) return 0.0;
  return std::sqrt((by_step * step).squaredNorm() * 2.0 / static_cast<double>(by_step.rows()));
}

double PixelMotion::sigma_px(const calibration::PoseMatrix& covariance) const {
  if (by_step.rows() == 0) return 0.0;
  const double trace = (by_step * covariance * by_step.transpose()).trace();
  return std::sqrt(std::max(trace, 0.0) * 2.0 / static_cast<double>(by_step.rows()));
}

PixelMotion pixel_motion(const calibration::ShowCalibration& room, const calibration::ShowProjector& projector) {
  constexpr int kColumns = 8;
  constexpr int kRows = 5;
  std::vector<Eigen::Matrix<double, 2, 6>> found;
  for (int i = 0; i < kColumns * kRows; ++i) {
    const Eigen::Vector2d pixel((i % kColumns + 0.5) / kColumns * projector.lens.width_px,
                                (i / kColumns + 0.5) / kRows * projector.lens.height_px);
    const auto wall = calibration::wall_lit_at(room, projector, pixel);
    if (!wall) continue;
    Eigen::Matrix<double, 2, 6> by;
    bool is_seen = true;
    for (int axis = 0; axis < 6 && is_seen; ++axis) {
      calibration::PoseStep step = calibration::PoseStep::Zero();
      step[axis] = axis < 3 ? kTurn_rad : kShift_m;
      const auto T = calibration::stepped(projector.T_room_projector, step).inverse();
      const auto moved = calibration::pixel_of(projector.lens, (T * Point<frame::Room>{*wall}).xyz);
      is_seen = !!moved;
      if (moved) by.col(axis) = (*moved - pixel) / step[axis];
    }
    if (is_seen) found.push_back(by);
  }
  PixelMotion motion;
  motion.by_step.resize(static_cast<Eigen::Index>(2 * found.size()), 6);
  for (std::size_t i = 0; i < found.size(); ++i)
    motion.by_step.middleRows<2>(static_cast<Eigen::Index>(2 * i)) = found[i];
  return motion;
}

}  // namespace cyclorama::healing

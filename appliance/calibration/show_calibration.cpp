// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibration/show_calibration.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace cyclorama::calibration {
namespace {

Status check(const BrownParameters& lens, const std::string& name) {
  const BrownBlock block = to_block(lens);
  bool is_finite = true;
  for (const double value : block) is_finite = is_finite && std::isfinite(value);
  if (is_finite && lens.width_px > 0 && lens.height_px > 0 && lens.focal_u_px > 0.0 && lens.focal_v_px > 0.0)
    return Done{};
  return Error(ErrorCode::kInvalidArgument, fmt::format("'{}' has a lens without size or focal length", name));
}

Eigen::Matrix2d jacobian(const BrownBlock& k, const Eigen::Vector2d& s) {
  const double x = s.x();
  const double y = s.y();
  const double rr = s.squaredNorm();
  const double radial = 1.0 + rr * (k[kK1] + rr * (k[kK2] + rr * k[kK3]));
  // Twice the derivative of radial by rr.
  const double growth = 2.0 * (k[kK1] + rr * (2.0 * k[kK2] + 3.0 * rr * k[kK3]));
  const double cross = x * y * growth + 2.0 * k[kP1] * x + 2.0 * k[kP2] * y;
  Eigen::Matrix2d j;
  j << k[kFocalU] * (radial + x * x * growth + 2.0 * k[kP1] * y + 6.0 * k[kP2] * x), k[kFocalU] * cross,
      k[kFocalV] * cross, k[kFocalV] * (radial + y * y * growth + 6.0 * k[kP1] * y + 2.0 * k[kP2] * x);
  return j;
}

}  // namespace

CodeLight gamma_light(double gamma) {
  CodeLight light{};
  for (std::size_t code = 0; code < light.size(); ++code)
    light[code] = static_cast<float>(std::pow(static_cast<double>(code) / 255.0, gamma));
  return light;
}

CodeLight rounded_light(CodeLight light) {
  constexpr float kSteps = 65535.0f;
  for (float& one : light) one = std::round(kSteps * std::clamp(one, 0.0f, 1.0f)) / kSteps;
  return light;
}

Status ShowCalibration::validate() const {
  if (projectors.empty()) return Error(ErrorCode::kInvalidArgument, "no projector");
  if (cameras.empty())
    return Error(ErrorCode::kInvalidArgument, "no camera watches the show; mount one beside each projector");
  for (const ShowProjector& projector : projectors) TRY(check(projector.lens, projector.name));
  for (const ShowCamera& camera : cameras) TRY(check(camera.lens, camera.name));
  return Done{};
}

std::optional<Eigen::Vector2d> slope_at(const BrownParameters& lens, const Eigen::Vector2d& pixel) {
  constexpr int kMaxSteps = 30;
  constexpr double kSettledPx = 1e-9;
  const BrownBlock block = to_block(lens);
  Eigen::Vector2d slope((pixel.x() - lens.centre_u_px) / lens.focal_u_px,
                        (pixel.y() - lens.centre_v_px) / lens.focal_v_px);
  for (int i = 0; i < kMaxSteps; ++i) {
    Eigen::Vector2d seen;
    brown_pixel(block.data(), slope.x(), slope.y(), &seen.x(), &seen.y());
    const Eigen::Vector2d missing = pixel - seen;
    const Eigen::Matrix2d slopes = jacobian(block, slope);
    if (!(slopes.determinant() > 0.0)) return std::nullopt;
    if (missing.norm() < kSettledPx) return slope;
    slope += slopes.inverse() * missing;
  }
  return std::nullopt;
}

std::optional<Eigen::Vector2d> pixel_of(const BrownParameters& lens, const Eigen::Vector3d& point) {
  if (!(point.z() > 1e-6)) return std::nullopt;
  const BrownBlock block = to_block(lens);
  Eigen::Vector2d pixel;
  brown_pixel(block.data(), point.x() / point.z(), point.y() / point.z(), &pixel.x(), &pixel.y());
  if (!pixel.allFinite()) return std::nullopt;
  return pixel;
}

bool contains(const BrownParameters& lens, const Eigen::Vector2d& pixel) {
  return pixel.x() >= 0.0 && pixel.x() <= lens.width_px && pixel.y() >= 0.0 && pixel.y() <= lens.height_px;
}

std::optional<Eigen::Vector3d> wall_seen_at(const ShowCalibration& room, const ShowCamera& camera,
                                            const Eigen::Vector2d& pixel) {
  const auto slope = slope_at(camera.lens, pixel);
  if (!slope) return std::nullopt;
  const auto point = hit_extended(
      room.wall, {{camera.T_room_camera.translation()}, camera.T_room_camera.rotation() * slope->homogeneous()});
  if (!point) return std::nullopt;
  return point->xyz;
}

std::optional<Eigen::Vector3d> wall_lit_at(const ShowCalibration& room, const ShowProjector& projector,
                                           const Eigen::Vector2d& pixel) {
  const auto slope = slope_at(projector.lens, pixel);
  if (!slope) return std::nullopt;
  const auto point = hit_extended(room.wall, {{projector.T_room_projector.translation()},
                                              projector.T_room_projector.rotation() * slope->homogeneous()});
  if (!point) return std::nullopt;
  return point->xyz;
}

}  // namespace cyclorama::calibration

// SPDX-License-Identifier: Apache-2.0
#include "appliance/solve/measurements.h"

#include <fmt/format.h>

#include <cmath>
#include <set>

namespace cyclorama::solve {
namespace {
constexpr int kMaxPx = 16384;

Error refused(std::string what) { return Error(ErrorCode::kInvalidArgument, std::move(what)); }
bool is_size(int px) { return px >= 16 && px <= kMaxPx; }
}  // namespace

Status Measurements::validate() const {
  if (directions.empty()) return refused("no direction was measured; take pictures in at least two that overlap");
  if (projectors.empty()) return refused("no projector is listed; name those of the installation");
  if (!is_size(camera.width_px) || !is_size(camera.height_px)) {
    return refused(fmt::format("the camera's picture is {}x{} pixels; 16 to {} each way are right", camera.width_px,
                               camera.height_px, kMaxPx));
  }
  for (const double value : camera.values) {
    if (!std::isfinite(value))
      return refused("a number of the camera's lens is not finite; calibrate the camera again");
  }
  if (!(camera.values[calibration::MeasuredLens::kFocal] > 1.0)) {
    return refused("the camera's focal length is not positive; give it in pixels");
  }
  if (!camera.covariance.allFinite() || !(camera.covariance.diagonal().minCoeff() >= 0.0)) {
    return refused("the covariance of the camera's lens is none; calibrate the camera again");
  }
  if (!(wall_distance_m > 0.0) || !(wall_distance_sigma_m > 0.0) || !std::isfinite(wall_distance_m) ||
      !std::isfinite(wall_distance_sigma_m) || !std::isfinite(pitch_rad)) {
    return refused("the distance to the wall is not positive; give it in metres");
  }
  std::set<std::string> names;
  for (const MeasuredProjector& projector : projectors) {
    if (!is_size(projector.width_px) || !is_size(projector.height_px)) {
      return refused(fmt::format("projector '{}' is {}x{} pixels; 16 to {} each way are right", projector.name,
                                 projector.width_px, projector.height_px, kMaxPx));
    }
    if (!names.insert(projector.name).second) {
      return refused(fmt::format("two projectors are named '{}'; give each its own name", projector.name));
    }
  }
  for (std::size_t d = 0; d < directions.size(); ++d) {
    const TurntableDirection& direction = directions[d];
    if (!std::isfinite(direction.angle_rad) || !(direction.sigma_rad > 0.0) || !std::isfinite(direction.sigma_rad)) {
      return refused(fmt::format("direction {}: its angle or its sigma is no valid number; check the turntable", d));
    }
    for (std::size_t i = 0; i < direction.correspondences.size(); ++i) {
      const Correspondence& c = direction.correspondences[i];
      if (c.projector >= projectors.size() || !std::isfinite(c.camera_u) || !std::isfinite(c.camera_v) ||
          !std::isfinite(c.projector_x) || !std::isfinite(c.projector_y) || !(c.sigma_px > 0.0f) ||
          !std::isfinite(c.sigma_px)) {
        return refused(fmt::format(
            "direction {}, correspondence {}: a number is not finite, or there is no such projector; decode again", d,
            i));
      }
    }
  }
  return Done{};
}

}  // namespace cyclorama::solve

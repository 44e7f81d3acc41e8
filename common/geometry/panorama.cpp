// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/panorama.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/picture_cut.h"

namespace cyclorama {
namespace {
constexpr int kMaxSidePx = 16384;
}  // namespace

Status Panorama::validate() const {
  const auto refuse = [](const char* field, double value, const char* legal) {
    return Error(ErrorCode::kInvalidArgument, fmt::format("panorama {} is {}; it must be {}", field, value, legal));
  };
  if (width_px < 1 || width_px > kMaxSidePx) return refuse("width_px", width_px, "1 to 16384");
  if (height_px < 1 || height_px > kMaxSidePx) return refuse("height_px", height_px, "1 to 16384");
  // Written so that NaN is refused.
  if (!(azimuth_span_rad > 0.0 && azimuth_span_rad <= 2.0 * std::numbers::pi + 1e-9)) {
    return refuse("azimuth_span_rad", azimuth_span_rad, "above 0 and at most 2 pi");
  }
  if (!std::isfinite(tan_elevation_bottom)) return refuse("tan_elevation_bottom", tan_elevation_bottom, "finite");
  if (!std::isfinite(tan_elevation_top) || !(tan_elevation_top > tan_elevation_bottom)) {
    return refuse("tan_elevation_top", tan_elevation_top, "finite and above tan_elevation_bottom");
  }
  return Done{};
}

Eigen::Vector3d Panorama::direction_at(PanoramaPixel p) const {
  const double azimuth = azimuth_at(p.u);
  return {std::sin(azimuth), tan_elevation_at(p.v), -std::cos(azimuth)};
}

PanoramaPixel Panorama::pixel_of(const Eigen::Vector3d& direction) const {
  const double azimuth = std::atan2(direction.x(), -direction.z());
  const double tan_elevation = direction.y() / std::hypot(direction.x(), direction.z());
  return {(azimuth / azimuth_span_rad + 0.5) * width_px,
          (tan_elevation - tan_elevation_top) / (tan_elevation_bottom - tan_elevation_top) * height_px};
}

Panorama Panorama::with_guard_band(double guard_rad) const {
  const double per_px = radians_per_px();
  const int wanted = width_px + 2 * static_cast<int>(std::ceil(std::max(guard_rad, 0.0) / per_px));
  const int rounded = (wanted + kCutPx - 1) / kCutPx * kCutPx;
  const int full_circle = static_cast<int>(std::floor(2.0 * std::numbers::pi / per_px + 1e-6));
  Panorama wider = *this;
  wider.width_px = std::max(width_px, std::min(rounded, full_circle));
  wider.azimuth_span_rad = per_px * wider.width_px;
  return wider;
}

bool is_whole_turn(const Panorama& picture) {
  return picture.azimuth_span_rad > 2.0 * std::numbers::pi - picture.radians_per_px();
}

double wrapped_angle(double angle) {
  const double wrapped = std::remainder(angle, 2.0 * std::numbers::pi);
  return wrapped <= -std::numbers::pi ? std::numbers::pi : wrapped;
}

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "appliance/interchange/display_warp.h"
#include "appliance/interchange/fault.h"
#include "appliance/interchange/map_sampling.h"

namespace cyclorama::interchange {
namespace {

using Look = std::function<std::optional<Eigen::Vector3d>(const float*)>;

constexpr double kRadians = std::numbers::pi / 180.0;
constexpr double kMinDistanceM = 1e-6;

Error lacking(const WarpRegion& region, std::string_view what, std::string_view remedy) {
  return Error(ErrorCode::kInvalidArgument, fmt::format("region '{}': {}; {}", region.id, what, remedy));
}

/// Returns the function that looks up u and v in the region's part of the picture, whose first row is at the top.
Look look_at_picture(const WarpRegion& region, const PictureShape& picture) {
  return [&region, &picture](const float* sample) -> std::optional<Eigen::Vector3d> {
    const double u = region.rect.x + region.rect.width * static_cast<double>(sample[0]);
    const double v = region.rect.y + region.rect.height * static_cast<double>(sample[1]);
    return direction_at(picture, {u * width_px(picture), (1.0 - v) * height_px(picture)});
  };
}

Look look_through_frustum(const WarpFrustum& f) {
  const Eigen::Quaterniond turned = Eigen::AngleAxisd(-f.yaw_deg * kRadians, Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(f.pitch_deg * kRadians, Eigen::Vector3d::UnitX()) *
                                    Eigen::AngleAxisd(-f.roll_deg * kRadians, Eigen::Vector3d::UnitZ());
  const double left = std::tan(f.left_deg * kRadians);
  const double right = std::tan(f.right_deg * kRadians);
  const double up = std::tan(f.up_deg * kRadians);
  const double down = std::tan(f.down_deg * kRadians);
  return [=](const float* sample) -> std::optional<Eigen::Vector3d> {
    const double u = static_cast<double>(sample[0]);
    const double v = static_cast<double>(sample[1]);
    return turned * Eigen::Vector3d(left + u * (right - left), down + v * (up - down), -1.0);
  };
}

Look look_at_points(double metres, const Eigen::Vector3d& eye_m) {
  return [=](const float* sample) -> std::optional<Eigen::Vector3d> {
    const Eigen::Vector3d seen = metres * Eigen::Vector3f(sample[0], sample[1], sample[2]).cast<double>() - eye_m;
    if (!(seen.norm() > kMinDistanceM)) return std::nullopt;  // Some exporters mark unmapped samples with zeros.
    return seen;
  };
}

Result<Look> look_of(const WarpRegion& region, WarpProfile profile, const WarpSetting& setting) {
  switch (profile) {
    case WarpProfile::k2d: {
      TRY(validate(setting.picture));
      return look_at_picture(region, setting.picture);
    }
    case WarpProfile::k3d: {
      if (!region.frustum) return lacking(region, "it has no frustum", "export it as 2d or a3, or with its frustum");
      return look_through_frustum(*region.frustum);
    }
    case WarpProfile::kAdvanced3d:
    case WarpProfile::kShaderLamps: {
      const auto metres = metres_in(region.unit);
      if (!metres) return lacking(region, "the file names no unit of length", "export it with its geometricUnit");
      if (region.origin == DataOrigin::kIdealEyePoint) return look_at_points(*metres, Eigen::Vector3d::Zero());
      if (!setting.eye_m) {
        return lacking(region, "its points do not begin at the eye", "give the sweet spot in the map's frame");
      }
      return look_at_points(*metres, *setting.eye_m);
    }
  }
  return lacking(region, "its profile is unknown", "export it again");
}

}  // namespace

Result<DirectionMap> directions_of(const WarpRegion& region, WarpProfile profile, const WarpSetting& setting) {
  if (!region.map) return lacking(region, "it has no geometryWarpFile", "export it with its warp");
  TRY(check(region, profile));
  TRY_ASSIGN(const Look look, look_of(region, profile, setting));
  DirectionMap directions(region.map->width(), region.map->height(), std::numeric_limits<float>::quiet_NaN());
  std::size_t seen = 0;
  for (int y = 0; y < directions.height(); ++y) {
    for (int x = 0; x < directions.width(); ++x) {
      const float* const sample = region.map->at(x, y);
      if (!is_mapped(sample)) continue;
      const auto direction = look(sample);
      if (!direction || !direction->allFinite()) continue;
      const Eigen::Vector3f unit = direction->normalized().cast<float>();
      std::copy(unit.data(), unit.data() + 3, directions.at(x, y));
      ++seen;
    }
  }
  if (seen == 0) {
    return fault(fmt::format("region '{}'", region.id), "no sample gives a direction",
                 "look whether the map, its unit and the picture belong together");
  }
  return directions;
}

}  // namespace cyclorama::interchange

// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibration/corrected_map.h"

#include <cmath>
#include <limits>

namespace cyclorama::calibration {
namespace {

/// Returns the point where the ray with that slope from that pose meets the extended wall.
std::optional<Eigen::Vector3d> landing(const Eigen::Vector2d& slope,
                                       const RigidTransform<frame::Room, frame::Projector>& pose, const Wall& wall) {
  const auto point = hit_extended(wall, {{pose.translation()}, pose.rotation() * slope.homogeneous()});
  if (!point || !point->xyz.allFinite()) return std::nullopt;
  return point->xyz;
}

bool is_same(const ShowFile::Projector& p) {
  return p.scanned.rotation().coeffs() == p.applied.rotation().coeffs() &&
         p.scanned.translation() == p.applied.translation();
}

}  // namespace

double moved_px(const ShowFile::Projector& projector, const Wall& wall) {
  constexpr int kSide = 12;
  double sum = 0.0;
  int met = 0;
  if (is_same(projector)) return 0.0;
  for (int i = 0; i < kSide * kSide; ++i) {
    const Eigen::Vector2d pixel((i % kSide + 0.5) / kSide * projector.lens.width_px,
                                (i / kSide + 0.5) / kSide * projector.lens.height_px);
    const auto slope = slope_at(projector.lens, pixel);
    if (!slope) continue;
    const auto at = landing(*slope, projector.applied, wall);
    if (!at) continue;
    const auto was = pixel_of(projector.lens, (projector.scanned.inverse() * Point<frame::Room>{*at}).xyz);
    if (!was) continue;
    sum += (*was - pixel).squaredNorm();
    ++met;
  }
  return met == 0 ? 0.0 : std::sqrt(sum / met);
}

MeasuredMap corrected_map(const MeasuredMap& map, const ShowFile::Projector& projector, const Wall& wall,
                          const Point<frame::Room>& sweet_spot) {
  if (is_same(projector)) return map;
  MeasuredMap made = map;
  // Uses the lens's size, since the map may have the size of one eye's pixels, which are stretched over the whole head.
  const double per_u = static_cast<double>(projector.lens.width_px) / map.cells_x;
  const double per_v = static_cast<double>(projector.lens.height_px) / map.cells_y;
  for (int y = 0; y <= map.cells_y; ++y) {
    for (int x = 0; x <= map.cells_x; ++x) {
      const auto index =
          static_cast<std::size_t>(y) * (static_cast<std::size_t>(map.cells_x) + 1) + static_cast<std::size_t>(x);
      Eigen::Vector3d& direction = made.directions[index];
      const auto lose = [&] {
        direction.setConstant(std::numeric_limits<double>::quiet_NaN());
        made.sigma_px[index] = std::numeric_limits<double>::infinity();
      };
      if (!direction.allFinite()) continue;
      const auto slope = slope_at(projector.lens, {x * per_u, y * per_v});
      const auto was = slope ? landing(*slope, projector.scanned, wall) : std::nullopt;
      const auto now = slope ? landing(*slope, projector.applied, wall) : std::nullopt;
      if (!was || !now) {
        lose();
        continue;
      }
      const Eigen::Vector3d before = *was - sweet_spot.xyz;
      const Eigen::Vector3d after = *now - sweet_spot.xyz;
      if (!(before.norm() > 1e-6 && after.norm() > 1e-6)) {
        lose();
        continue;
      }
      direction = (Eigen::Quaterniond::FromTwoVectors(before, after) * direction).normalized();
    }
  }
  return made;
}

}  // namespace cyclorama::calibration

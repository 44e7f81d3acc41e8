// SPDX-License-Identifier: Apache-2.0
#include "tests/data_sets/left_over.h"

#include <cmath>
#include <limits>

#include "appliance/healing/estimator/show_fit.h"

namespace cyclorama {
namespace {

constexpr int kCell_px = 60;  // Approximate correlation length that a map's smoothing leaves of independent errors.
constexpr double kFullWidth_px = 1920.0;

calibration::MeasuredMap measured(const calibration::ShowCalibration& truth,
                                  const calibration::ShowProjector& projector, double sigma_px,
                                  simulated::RandomStream* draws) {
  calibration::MeasuredMap map;
  map.width_px = projector.lens.width_px;
  map.height_px = projector.lens.height_px;
  const double scale = map.width_px / kFullWidth_px;
  map.cells_x = std::max(8, static_cast<int>(std::lround(map.width_px / (kCell_px * scale))));
  map.cells_y = std::max(6, static_cast<int>(std::lround(map.height_px / (kCell_px * scale))));
  for (int y = 0; y <= map.cells_y; ++y) {
    for (int x = 0; x <= map.cells_x; ++x) {
      // The direction of a nearby pixel serves as the direction with an error.
      const Eigen::Vector2d off(draws->about_zero(1.7 * sigma_px * scale), draws->about_zero(1.7 * sigma_px * scale));
      const Eigen::Vector2d pixel(static_cast<double>(x) / map.cells_x * map.width_px,
                                  static_cast<double>(y) / map.cells_y * map.height_px);
      const auto position = calibration::wall_lit_at(truth, projector, pixel + off);
      map.directions.push_back(position ? (*position - truth.sweet_spot.xyz).normalized().eval()
                                        : Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()).eval());
      map.sigma_px.push_back(sigma_px);
    }
  }
  return map;
}

}  // namespace

std::optional<Eigen::Vector3d> believed_position(const calibration::ShowCalibration& truth,
                                                 const calibration::ShowCalibration& room,
                                                 const Eigen::Vector3d& position) {
  const auto hit = hit_extended(room.wall, {{room.sweet_spot.xyz}, (position - truth.sweet_spot.xyz).normalized()});
  if (!hit) return std::nullopt;
  return hit->xyz;
}

Result<calibration::ShowCalibration> calibrated(const calibration::ShowCalibration& truth, const LeftOver& left,
                                                simulated::RandomStream draws) {
  calibration::ShowCalibration room = truth;
  for (int i = 0; i < 3; ++i) room.sweet_spot.xyz[i] += draws.about_zero(left.sweet_spot_m);
  for (calibration::ShowProjector& projector : room.projectors) {
    const calibration::MeasuredMap map = measured(truth, projector, left.map_px, &draws);
    TRY_ASSIGN(const auto fitted, healing::fit_projector(map, room.wall, room.sweet_spot, projector));
    projector.lens = fitted.lens;
    projector.T_room_projector = fitted.pose;
  }
  for (std::size_t i = 0; i < room.cameras.size(); ++i) {
    calibration::ShowCamera& camera = room.cameras[i];
    const double focal = 1.0 + draws.about_zero(left.camera_focal);
    camera.lens.focal_u_px *= focal;
    camera.lens.focal_v_px *= focal;
    camera.lens.centre_u_px += draws.about_zero(left.camera_centre_px);
    camera.lens.centre_v_px += draws.about_zero(left.camera_centre_px);
    std::vector<healing::WallCorrespondence> pixels;
    constexpr int kAcross = 40;
    constexpr int kDown = 30;
    for (int k = 0; k < kAcross * kDown; ++k) {
      const Eigen::Vector2d pixel((k % kAcross + 0.5) / kAcross * camera.lens.width_px,
                                  (k / kAcross + 0.5) / kDown * camera.lens.height_px);
      const auto position = calibration::wall_seen_at(truth, truth.cameras[i], pixel);
      if (!position) continue;
      // Only the lit part is known.
      bool is_lit = false;
      for (const calibration::ShowProjector& projector : truth.projectors) {
        const auto at =
            pixel_of(projector.lens, (projector.T_room_projector.inverse() * Point<frame::Room>{*position}).xyz);
        is_lit = is_lit || (at && contains(projector.lens, *at));
      }
      const auto known = is_lit ? believed_position(truth, room, *position) : std::nullopt;
      if (!known) continue;
      const Eigen::Vector2d noise(draws.about_zero(1.7 * left.camera_pixel_px),
                                  draws.about_zero(1.7 * left.camera_pixel_px));
      pixels.push_back({pixel + noise, *known});
    }
    TRY_ASSIGN(const auto placed, healing::place_camera(camera.lens, pixels));
    camera.T_room_camera = placed.pose;
  }
  return room;
}

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/camera_placement.h"

#include <fmt/format.h>

#include <algorithm>

#include "appliance/healing/estimator/show_fit.h"
#include "appliance/scan/view_measuring.h"

namespace cyclorama::healing {
namespace {

constexpr std::size_t kMaxCorrespondences = 1500;  // Per projector and camera; more add no information.

/// Returns the pixels at which a camera sees one projector's light, each with its point on the wall.
std::vector<WallCorrespondence> places_of(const scan::ScanView& view, const calibration::MeasuredMap& map,
                                          const Installation& installation) {
  std::vector<WallCorrespondence> pixels;
  const std::size_t every = std::max<std::size_t>(1, view.correspondences.size() / kMaxCorrespondences);
  for (std::size_t i = 0; i < view.correspondences.size(); i += every) {
    const solve::Correspondence& seen = view.correspondences[i];
    const Eigen::Vector2d lit(static_cast<double>(seen.projector_x), static_cast<double>(seen.projector_y));
    const auto direction = map.direction_at(lit);
    if (!direction) continue;
    const auto position = hit_extended(installation.wall, {{installation.sweet_spot.xyz}, *direction});
    if (position)
      pixels.push_back({{static_cast<double>(seen.camera_u), static_cast<double>(seen.camera_v)}, position->xyz});
  }
  return pixels;
}

}  // namespace

Result<std::vector<PlacedCamera>> place_cameras(const std::vector<WatchingCamera>& cameras, PlacementDevices& devices,
                                                const calibration::Calibration& calibration,
                                                const Installation& installation,
                                                const structured_light::ExposureLimits& exposure,
                                                std::stop_token stop) {
  std::vector<PlacedCamera> placed;
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    const WatchingCamera& camera = cameras[k];
    scan::ScanCamera& eye = *devices.cameras[k];
    if (eye.width_px() != camera.lens.width_px || eye.height_px() != camera.lens.height_px) {
      placed.push_back({camera.name, camera.lens, {}});
      placed.back().trouble =
          fmt::format("camera '{}' gives pictures of {}x{}, but its lens was calibrated for {}x{}", camera.name,
                      eye.width_px(), eye.height_px(), camera.lens.width_px, camera.lens.height_px);
      continue;
    }
    std::vector<WallCorrespondence> pixels;
    scan::ViewSettings settings;
    settings.exposure = exposure;
    std::optional<double> exposure_s;
    for (std::size_t p = 0; p < installation.projectors.size(); ++p) {
      const InstalledProjector& lamp = installation.projectors[p];
      const auto found = std::ranges::find(calibration.projectors, lamp.name, &calibration::CalibratedProjector::name);
      if (found == calibration.projectors.end()) continue;
      const scan::ViewOrder order{p, lamp.name, lamp.lens.width_px, lamp.lens.height_px, exposure_s};
      TRY_ASSIGN(const scan::ScanView view, scan::measure_view(order, settings, *devices.screen, eye, {}, stop));
      TRY(devices.screen->show(p, RgbImage()));
      if (view.exposure_s > 0.0) exposure_s = view.exposure_s;
      const auto some = places_of(view, found->map, installation);
      pixels.insert(pixels.end(), some.begin(), some.end());
    }
    auto fitted = place_camera(camera.lens, pixels);
    placed.push_back({camera.name, camera.lens, {}});
    if (!fitted) {
      placed.back().trouble = fmt::format("camera '{}': {}", camera.name, fitted.error().message());
      continue;
    }
    placed.back() = {camera.name, camera.lens, fitted->pose, fitted->used, fitted->rms_px};
  }
  if (!placed.empty() && std::ranges::none_of(placed, &std::string::empty, &PlacedCamera::trouble))
    return Error(ErrorCode::kBadData, placed.front().trouble);
  return placed;
}

}  // namespace cyclorama::healing

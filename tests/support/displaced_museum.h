// SPDX-License-Identifier: Apache-2.0
/// A calibrated simulated museum whose parts are displaced later.
#pragma once

#include <memory>

#include "appliance/scan/realign/realignment.h"
#include "appliance/scan/simulated_devices.h"
#include "drivers/simulated/museum/presets.h"
#include "drivers/simulated/turntable/simulated_turntable.h"
#include "tests/support/museum_score.h"

namespace cyclorama {

class DisplacedMuseum {
 public:
  DisplacedMuseum(simulated::Preset preset, double field_of_view_rad, double pitch_rad)
      : preset_(std::move(preset)), field_of_view_rad_(field_of_view_rad), pitch_rad_(pitch_rad) {}

  [[nodiscard]] const simulated::Preset& preset() const { return preset_; }
  [[nodiscard]] simulated::MuseumTruth& truth() { return preset_.truth; }

  /// Rotates a projector about an axis through its centre, and translates it. Both vectors are in the projector's
  /// frame; their lengths are ignored.
  void push(std::size_t projector, double angle_rad, const Eigen::Vector3d& axis, double by_m,
            const Eigen::Vector3d& towards) {
    auto& pose = preset_.truth.projectors[projector].T_room_projector;
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle_rad, axis.normalized()));
    pose = {pose.rotation() * turn, pose.translation() + by_m * (pose.rotation() * towards.normalized())};
  }
  void turn_lens(std::size_t projector, double zoom, double shift_px) {
    simulated::TrueProjector& p = preset_.truth.projectors[projector];
    Pinhole lens = p.lens.pinhole();
    lens.focal_px *= zoom;
    lens.centre_v_px += shift_px;
    p.lens = simulated::TrueLens(lens);
  }
  /// Moves the turntable, as when a tripod is not put back exactly on its marks.
  void put_turntable_elsewhere(const Eigen::Vector3d& by_m, double heading_rad) {
    auto& pose = preset_.truth.turntable.T_room_turntable;
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(heading_rad, Eigen::Vector3d::UnitY()));
    pose = {pose.rotation() * turn, pose.translation() + by_m};
  }

  /// Calls `body`(museum, devices, settings) with the museum in its present state.
  template <typename Body>
  Status inside(const Body& body) const {
    TRY_ASSIGN(simulated::SimulatedMuseum museum,
               simulated::SimulatedMuseum::make(preset_.installation, preset_.truth));
    scan::SimulatedPatternScreen screen(&museum);
    scan::SimulatedScanCamera camera(&museum, scan::PhotographColour::kGrey);
    scan::SimulatedScanCamera colour_camera(&museum, scan::PhotographColour::kColour);
    simulated::SimulatedTurntable turntable(&museum);
    scan::ScanSettings settings;
    settings.camera = scan::data_sheet_lens(camera.width_px(), camera.height_px(), field_of_view_rad_);
    settings.pitch_rad = pitch_rad_;
    body(museum, scan::ScanDevices{screen, camera, turntable, &colour_camera}, settings);
    return Done{};
  }

 private:
  simulated::Preset preset_;
  double field_of_view_rad_;
  double pitch_rad_;
};

/// Returns the true score of a calibration.
inline MuseumScore score_of(const simulated::SimulatedMuseum& museum, const calibration::Calibration& calibration) {
  return museum_score(museum.truth(), [&](std::size_t p, const Eigen::Vector2d& pixel) {
    return calibration.projectors[p].map.direction_at(pixel);
  });
}

}  // namespace cyclorama

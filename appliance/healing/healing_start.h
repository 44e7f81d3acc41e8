// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "appliance/calibration/show_file.h"
#include "appliance/healing/camera_placement.h"
#include "common/room/installation.h"

namespace cyclorama::healing {

/// Reason and remedy if no camera watches.
inline constexpr const char* kNoCameraWatches = "no camera watches; name one in calibrator.toml, or with --watch";

/// Initial state of the calibration during the show.
struct HealingStart {
  calibration::ShowFile show;
  std::vector<std::size_t> cameras;   ///< Indices into the watching cameras, in the order of show.cameras.
  std::vector<std::string> troubles;  ///< Cameras and projectors that are left out, with reason and remedy.
};

/// Reads the room from the calibrator's folder, for a calibration that continues during the show.
///
///     calibration.json ── maps ─▶ fit_projector() ─▶ scanned     if the calibration is newer than watch.json
///     watch.json ────────────────────────────────▶ cameras; also scanned, applied and learned, if of the same date
///
/// A camera that was never placed, or whose lens has changed since, is left out; likewise a projector whose map fits no
/// pose. The response from codes to light is taken from the calibration's colours.json if there is one. Errors:
/// kNotFound if there is no calibration, or no camera's pose is known, with the remedy; kBadData if a file is damaged,
/// or no projector's map fits a pose.
Result<HealingStart> healing_start(const std::filesystem::path& folder, const Installation& installation,
                                   const std::vector<WatchingCamera>& cameras);

/// Writes watch.json with the cameras' poses after a placement, and returns its contents. A camera that could not be
/// placed keeps the pose that watch.json has for the same calibration. Projectors keep their poses; what was learned of
/// their residuals is discarded.
Result<calibration::ShowFile> save_camera_poses(const std::filesystem::path& folder, const Installation& installation,
                                                const std::vector<PlacedCamera>& cameras);

/// Returns the calibration with the present corrections: the positions where the projectors' light lands. Errors: those
/// of read_calibration().
Result<calibration::Calibration> corrected_calibration(const std::filesystem::path& folder,
                                                       const Installation& installation);

/// Returns the applied room for ContinuousCalibrator, for pictures reduced by `factor` each way.
[[nodiscard]] calibration::ShowCalibration applied_room(const calibration::ShowFile& show,
                                                        const Installation& installation, int factor);
/// Returns the learned room; empty if the scan's residuals have not been learned yet.
[[nodiscard]] std::optional<LearnedRoom> learned_room(const calibration::ShowFile& show,
                                                      const Installation& installation, int factor);

}  // namespace cyclorama::healing

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "appliance/calibration/show_file.h"
#include "appliance/healing/camera_placement.h"
#include "common/room/installation.h"

namespace cyclorama::healing {

/// What to do where there is nothing to go on with.
inline constexpr const char* kNoCameraWatches = "no camera watches; name one in calibrator.toml, or with --watch";

/// What there is to go on with.
struct HealingStart {
  calibration::ShowFile show;
  std::vector<std::size_t> cameras;   ///< Which of those that watch: show.cameras, in its order.
  std::vector<std::string> troubles;  ///< Who is left out, why, and what to do about it.
};

/// What the calibrator's folder says of the room, for a calibration that goes on during the show.
///
///     calibration.json ── maps ─▶ fit_projector() ─▶ scanned     of a calibration that is new to watch.json
///     watch.json ────────────────────────────────▶ cameras; scanned, applied and learned too, if it is of this one
///
/// Of one camera that was never placed, or has another lens since, and of one projector whose map no place fits, it
/// goes on without; how codes become light is taken from the calibration's colours.json where there is one.
/// kNotFound  there is no calibration, or nobody knows yet where any of the cameras stands: says what to do.
/// kBadData  a file is damaged, or no projector's map fits a place.
Result<HealingStart> healing_start(const std::filesystem::path& folder, const Installation& installation,
                                   const std::vector<WatchingCamera>& cameras);

/// The same after the cameras were placed, but for those that were not; what is known of projectors stays. Writes
/// watch.json.
Result<calibration::ShowFile> save_camera_poses(const std::filesystem::path& folder, const Installation& installation,
                                                const std::vector<PlacedCamera>& cameras);

/// With the corrections that count now: where the projectors' light lands. Errors of read_calibration().
Result<calibration::Calibration> corrected_calibration(const std::filesystem::path& folder,
                                                       const Installation& installation);

/// For ContinuousCalibrator; pictures are smaller by `factor`.
[[nodiscard]] calibration::ShowCalibration applied_room(const calibration::ShowFile& show,
                                                        const Installation& installation, int factor);
/// Nothing where it has not been learned yet what the scan left over.
[[nodiscard]] std::optional<LearnedRoom> learned_room(const calibration::ShowFile& show,
                                                      const Installation& installation, int factor);

}  // namespace cyclorama::healing

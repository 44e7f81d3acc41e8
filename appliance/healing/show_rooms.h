// SPDX-License-Identifier: Apache-2.0
/// The two kinds of room: a museum's, and one whose cameras are simulated in this process.
#pragma once

#include "appliance/healing/remote_shown.h"
#include "appliance/healing/show_room.h"
#include "appliance/scan/device_lines.h"
#include "drivers/camera/camera.h"
#include "drivers/simulated/museum/simulated_stage.h"

namespace cyclorama::healing {

/// Displays of a room, and the parameters of requests for their pictures.
struct ShowDisplays {
  std::vector<InstalledProjector> projectors;
  std::vector<scan::PatternDisplay> displays;
  int factor = 1;
  Duration latency{};  ///< Time from a projector's signal to its light.
  std::chrono::milliseconds settle{100};
};

/// Returns a museum's room, whose cameras are opened by make_camera(). The lens of each camera is read from NAME.json,
/// which cyclorama-calibrate-camera writes, in the first folder of `lenses` that has this file. A camera without a lens
/// file, or with a damaged one, is in troubles(). Borrows the clock.
[[nodiscard]] std::unique_ptr<ShowRooms> museum_rooms(ShowDisplays displays,
                                                      const std::vector<scan::CameraSource>& cameras,
                                                      const std::vector<std::filesystem::path>& lenses,
                                                      double exposure_s, const Clock& clock);

/// Returns a room that simulates the stage's cameras from the pictures that the displays report.
[[nodiscard]] std::unique_ptr<ShowRooms> simulated_rooms(ShowDisplays displays, simulated::SimulatedStage stage,
                                                         const Clock& clock);

}  // namespace cyclorama::healing

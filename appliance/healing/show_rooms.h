// SPDX-License-Identifier: Apache-2.0
/// The two kinds of room: a museum's, and one whose cameras are simulated in this process.
#pragma once

#include "appliance/healing/remote_shown.h"
#include "appliance/healing/show_room.h"
#include "appliance/scan/device_lines.h"
#include "drivers/camera/camera.h"
#include "drivers/simulated/museum/simulated_stage.h"

namespace cyclorama::healing {

/// The displays, and the parameters of requests for their pictures.
struct ShowDisplays {
  std::vector<InstalledProjector> projectors;
  std::vector<scan::PatternDisplay> displays;
  int factor = 1;
  Duration latency{};  ///< From a projector's signal to its light.
  std::chrono::milliseconds settle{100};
};

/// Opens cameras of make_camera(), each with its lens, as cyclorama-calibrate-camera writes it, from the first folder
/// of `lenses` that has a file NAME.json. A camera without a lens file, or with a damaged one, is in troubles().
/// Borrows the clock.
[[nodiscard]] std::unique_ptr<ShowRooms> museum_rooms(ShowDisplays displays,
                                                      const std::vector<scan::CameraSource>& cameras,
                                                      const std::vector<std::filesystem::path>& lenses,
                                                      double exposure_s, const Clock& clock);

/// Simulates the stage's cameras from the pictures that the displays report.
[[nodiscard]] std::unique_ptr<ShowRooms> simulated_rooms(ShowDisplays displays, simulated::SimulatedStage stage,
                                                         const Clock& clock);

}  // namespace cyclorama::healing

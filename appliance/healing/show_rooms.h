// SPDX-License-Identifier: Apache-2.0
/// The rooms that there are: a museum's, and one that is simulated in this process but for its displays.
#pragma once

#include "appliance/healing/remote_shown.h"
#include "appliance/healing/show_room.h"
#include "appliance/scan/device_lines.h"
#include "drivers/camera/camera.h"
#include "drivers/simulated/museum/simulated_stage.h"

namespace cyclorama::healing {

/// The displays, and how their pictures are asked for.
struct ShowDisplays {
  std::vector<InstalledProjector> projectors;
  std::vector<scan::PatternDisplay> displays;
  int factor = 1;
  Duration latency{};  ///< From a projector's signal to its light.
  std::chrono::milliseconds settle{100};
};

/// Cameras of make_camera(), each with its lens, as cyclorama-calibrate-camera writes it, in the first of `lenses` that
/// has a file NAME.json. A camera without is in troubles(), and so is one whose file is damaged. Borrows the clock.
[[nodiscard]] std::unique_ptr<ShowRooms> museum_rooms(ShowDisplays displays,
                                                      const std::vector<scan::CameraSource>& cameras,
                                                      const std::vector<std::filesystem::path>& lenses,
                                                      double exposure_s, const Clock& clock);

/// The stage's cameras see what the displays say that they show.
[[nodiscard]] std::unique_ptr<ShowRooms> simulated_rooms(ShowDisplays displays, simulated::SimulatedStage stage,
                                                         const Clock& clock);

}  // namespace cyclorama::healing

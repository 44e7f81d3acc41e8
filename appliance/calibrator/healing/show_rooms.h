// SPDX-License-Identifier: Apache-2.0
/// The rooms that there are: a museum's, and one that is simulated in this process but for its displays.
#pragma once

#include "appliance/calibrator/healing/remote_shown.h"
#include "appliance/calibrator/healing/show_room.h"
#include "drivers/camera/camera.h"
#include "drivers/simulated_room/simulated_stage.h"

namespace cyclorama {

/// The displays, and how their pictures are asked for.
struct ShowDisplays {
  std::vector<InstalledProjector> projectors;
  std::vector<PatternDisplay> displays;
  int factor = 1;
  Duration latency{};  ///< From a projector's signal to its light.
  std::chrono::milliseconds settle{100};
};

/// "NAME=CAMERA", CAMERA as drivers/camera/make_camera.h has it.
struct CameraPlug {
  std::string name;
  std::string spec;
};
/// kInvalidArgument  another form, or a name that is no file's.
Result<CameraPlug> parse_camera_plug(const std::string& text);

/// Cameras of make_camera(), each with its lens in FOLDER/cameras/NAME.json, as cyclorama-calibrate-camera writes it.
/// Errors of read_camera(), with the camera's name. Borrows the clock.
Result<std::unique_ptr<ShowRooms>> museum_rooms(ShowDisplays displays, const std::vector<CameraPlug>& cameras,
                                                const std::filesystem::path& lenses, double exposure_s,
                                                const Clock& clock);

/// The stage's cameras see what the displays say that they show.
[[nodiscard]] std::unique_ptr<ShowRooms> simulated_rooms(ShowDisplays displays, SimulatedStage stage,
                                                         const Clock& clock);

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
/// Any camera from one line of text, as it stands in a config file or behind --camera:
///
///   file:PATH[?frames_per_second=N][&loop=no]   a photo, a folder of photos, or a video
///   simulated[:SIMULATION.toml]                 a hand with a tag; without a file, the demo's
///
/// Real devices are further kinds in the same table.
#pragma once

#include <memory>
#include <string_view>

#include "drivers/camera/camera.h"

namespace cyclorama {

/// Borrows `clock` for the camera's whole life.
///
/// kInvalidArgument  the line itself is wrong and says what is legal; trying again cannot help.
/// kNotFound, kBadData, kSystem  what it names cannot be opened (now).
Result<std::unique_ptr<Camera>> make_camera(std::string_view spec, const Clock& clock);

}  // namespace cyclorama

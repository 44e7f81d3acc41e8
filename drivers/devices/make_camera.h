// SPDX-License-Identifier: Apache-2.0
/// Any camera from one line of text, as it stands in a config file or behind --camera:
///
///   v4l2:PLACE[?OPTIONS]                        a camera of the kernel's, by its port, "usb-0000:00:14.0-2", by its
///   path,
///                                               "/dev/v4l/by-path/...", or, with no PLACE, the first that is there
///   libcamera:ID[?OPTIONS]                      one that only libcamera drives, by its id, or the first that is there
///   file:PATH[?frames_per_second=N][&loop=no]   a photo, a folder of photos, or a video
///   simulated[:SIMULATION.toml]                 a hand with a tag; without a file, the demo's
///
/// OPTIONS of the first two: width_px=N height_px=N frames_per_second=N exposure_ms=N (0: the camera's own), joined by
/// '&'; colour=yes (colours beside the brightness, where it has them); of v4l2 also gain=held (pictures are to be
/// compared: gain, white balance and focus stay as they are) and memory=dma_buf.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "drivers/camera/camera.h"
#include "drivers/camera/listed_camera.h"

namespace cyclorama {

/// Borrows `clock` for the camera's whole life.
///
/// kInvalidArgument  the line itself is wrong and says what is legal; trying again cannot help.
/// kNotFound, kBusy, kUnavailable, kBadData, kSystem  what it names cannot be opened (now).
Result<std::unique_ptr<Camera>> make_camera(std::string_view spec, const Clock& clock);

/// The real cameras of this machine. Blocks while the drivers are asked, a second at most.
[[nodiscard]] std::vector<ListedCamera> list_cameras();

}  // namespace cyclorama

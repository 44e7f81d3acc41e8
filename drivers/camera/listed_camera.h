// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace cyclorama::camera {

/// A camera that is present now, with the line that selects it in tracker.toml.
struct ListedCamera {
  std::string spec;     ///< Line for make_camera(); it names the port, so that it remains valid after a restart.
  std::string name;     ///< Product name given by the manufacturer.
  std::string path;     ///< Current device path; may change at the next start.
  std::string sends;    ///< Default picture format, such as "640x480 YUYV at 30 per second".
  std::string problem;  ///< Reason why the camera cannot be used now; empty if it can.
};

}  // namespace cyclorama::camera

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace cyclorama::camera {

/// A camera that is there now, for people who look for the line to write into tracker.toml.
struct ListedCamera {
  std::string spec;     ///< For make_camera(): names the port, so that it stays right.
  std::string name;     ///< What its maker calls it.
  std::string path;     ///< What the system calls it now; may change at the next start.
  std::string sends;    ///< What would be taken by default, "640x480 YUYV at 30 per second".
  std::string problem;  ///< Why it cannot be used now; empty when it can.
};

}  // namespace cyclorama::camera

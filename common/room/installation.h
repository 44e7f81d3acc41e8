// SPDX-License-Identifier: Apache-2.0
/// installation.toml: what stands in the room. The display makes its warps from it until calibration measures better
/// ones; the simulated room is built from it.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/panorama.h"
#include "common/geometry/rigid_transform.h"
#include "common/room/pinhole.h"
#include "common/room/wall.h"

namespace cyclorama {

struct InstalledProjector {
  std::string name;  ///< "left": its key in pages, pictures and files.
  Pinhole lens;
  RigidTransform<frame::Room, frame::Projector> T_room_projector;
};

/// A value; reentrant.
struct Installation {
  std::string name;
  CylinderWall wall;
  Point<frame::Room> sweet_spot;  ///< Where the visitor's eye is.
  std::vector<InstalledProjector> projectors;

  /// The panorama of the sweet spot that just covers the wall, `width_px` wide, with square pixels in the middle.
  /// For an eye off the cylinder's axis it covers the nearest and the farthest edge.
  [[nodiscard]] Panorama panorama(int width_px) const;
};

/// Errors as Config::read(); a room in which a projector or the eye is not inside the wall's cylinder is refused.
Result<Installation> read_installation(const std::filesystem::path& path);
/// `name` stands for the file in errors.
Result<Installation> parse_installation(std::string_view text, std::string name);

}  // namespace cyclorama

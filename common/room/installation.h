// SPDX-License-Identifier: Apache-2.0
/// installation.toml: what stands in the room. The display makes its warps from it until calibration measures better
/// ones; the simulated room is built from it.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/projection.h"
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
  Wall wall;
  Point<frame::Room> sweet_spot;  ///< Where the visitor's eye is.
  std::vector<InstalledProjector> projectors;

  /// The least picture of the sweet spot that just covers the wall, `width_px` wide.
  ///
  ///   one plane               perspective, on a plane whose tilt is the wall's; unless it reaches beyond 75 degrees
  ///   a dome                  fisheye about the dome's axis
  ///   all else                panorama; what leaves the sweet spot in a corner's direction lands in the corner, so flat
  ///                           pieces need no picture of their own. A fisheye if it rises or falls beyond 75 degrees,
  ///                           where a tangent of elevation wastes its rows.
  ///
  /// `height_px` of 0: square pixels; of a fisheye the width.
  [[nodiscard]] PictureShape picture(int width_px, int height_px = 0) const;
  /// The panorama of the sweet spot that just covers the wall, with square pixels in the middle, whatever its elevations.
  [[nodiscard]] Panorama panorama(int width_px) const;
};

/// Errors as Config::read(); a room in which a projector or the eye is not on the wall's lit side is refused. A mesh's
/// file lies in the installation's folder.
Result<Installation> read_installation(const std::filesystem::path& path);
/// `name` stands for the file in errors.
Result<Installation> parse_installation(std::string_view text, std::string name,
                                        const std::filesystem::path& folder = {});

}  // namespace cyclorama

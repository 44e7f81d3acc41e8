// SPDX-License-Identifier: Apache-2.0
/// installation.toml: what stands in the room. The display makes its warps from it until calibration measures better
/// ones; the simulated room is built from it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/address.h"
#include "common/base/result.h"
#include "common/geometry/projection.h"
#include "common/geometry/rigid_transform.h"
#include "common/room/pinhole.h"
#include "common/room/stereo.h"
#include "common/room/wall.h"

namespace cyclorama {

/// Where a projector's cable ends, and how its picture lies on the panel.
struct Plug {
  std::optional<int> card{};  ///< Counted from 0, in the order of Installation::cards; nothing: the first that fits.
  std::string connector{};    ///< "HDMI-A-1"; empty: any that is free.
  int turn_deg = 0;           ///< Clockwise: 0, 90, 180, 270.
};

/// How a projector is switched over the network.
struct PjlinkPlace {
  Address address;
  std::filesystem::path password_file{};  ///< Empty: it wants no password.
};

/// A warp that another program measured (appliance/interchange reads it): what the display draws with instead of what
/// follows from the projector's place.
struct InstalledWarp {
  std::filesystem::path file;  ///< In the installation's folder.
  std::string region;          ///< Of a file with several; empty: the one with the projector's name, or the only one.
  std::filesystem::path mask;  ///< A PNG that belongs to a PFM; empty: none.
};

struct InstalledProjector {
  std::string name;  ///< "left": its key in pages, pictures and files.
  Pinhole lens;
  RigidTransform<frame::Room, frame::Projector> T_room_projector;
  Plug plug{};
  std::optional<PjlinkPlace> pjlink{};  ///< Nothing: it is switched by hand.
  std::optional<InstalledWarp> warp = {};
};

/// A value; reentrant.
struct Installation {
  std::string name;
  Wall wall;
  Point<frame::Room> sweet_spot;  ///< Where the visitor's eye is.
  std::vector<InstalledProjector> projectors;
  std::vector<std::filesystem::path> cards{};  ///< The first one draws; empty: all that the computer has.
  std::optional<InstalledStereo> stereo{};     ///< Nothing: one picture for both eyes.

  /// The least picture of the sweet spot that just covers the wall, `width_px` wide.
  ///
  ///   one plane               perspective, on a plane whose tilt is the wall's; unless it reaches beyond 75 degrees
  ///   a dome                  fisheye about the dome's axis
  ///   all else                panorama; what leaves the sweet spot in a corner's direction
  ///                           lands in the corner, so flat pieces need no picture of their own.
  ///                           A fisheye if it rises or falls beyond 75 degrees, where a tangent
  ///                           of elevation wastes its rows.
  ///
  /// `height_px` of 0: square pixels; of a fisheye the width.
  [[nodiscard]] PictureShape picture(int width_px, int height_px = 0) const;
  /// The panorama of the sweet spot that just covers the wall, with square pixels in the middle, whatever its
  /// elevations.
  [[nodiscard]] Panorama panorama(int width_px) const;
  /// picture() for one eye; or for both, if there is stereo, each of so many pixels but for the height, which is
  /// rounded up to a cut.
  [[nodiscard]] Projection projection(int width_px, int height_px = 0) const;
  /// How far from the sweet spot the eyes converge, which is Viewing::screen_distance_m of `picture`: exact for a
  /// cylinder about the sweet spot, a plane and a dome about it. Of other walls it is one over the mean of what is
  /// nearer, the more: disparity goes by that.
  [[nodiscard]] double screen_distance_m(const PictureShape& picture) const;
};

/// HOST or HOST:PORT; without a port PJLink's. Errors of parse_address().
Result<Address> parse_projector_address(const std::string& text);

/// Errors as Config::read(); a room in which a projector or the eye is not on the wall's lit side is refused. Meshes
/// and warps lie in the installation's folder; a warp is not opened here.
Result<Installation> read_installation(const std::filesystem::path& path);
/// `name` stands for the file in errors.
Result<Installation> parse_installation(std::string_view text, std::string name,
                                        const std::filesystem::path& folder = {});

}  // namespace cyclorama

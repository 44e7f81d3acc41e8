// SPDX-License-Identifier: Apache-2.0
/// installation.toml: the objects in the room. The display computes its warps from it until a calibration has measured
/// better ones; the simulated room is also built from it.
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

/// Connector of a projector, and the rotation of its picture.
struct Plug {
  std::optional<int> card{};  ///< Index into Installation::cards, from 0; absent: the first card that fits.
  std::string connector{};    ///< Such as "HDMI-A-1"; empty: by `serial`, or any free connector.
  std::string serial{};       ///< Serial of its EDID, by which it is found on any connector; empty: none.
  std::filesystem::path edid{};      ///< EDID that replaces the reported one; empty: none.
  bool is_always_connected = false;  ///< Driven even if nothing seems connected, as `edid` states.
  int turn_deg = 0;           ///< Clockwise: 0, 90, 180, 270.
};

/// Network address at which a projector is switched on and off.
struct PjlinkPlace {
  Address address;
  std::filesystem::path password_file{};  ///< Empty: no password.
};

/// A warp measured by another program (appliance/interchange reads it). The display uses it instead of the warp that
/// follows from the projector's pose.
struct InstalledWarp {
  std::filesystem::path file;  ///< In the installation's folder.
  /// Region in a file with several regions; empty: the one with the projector's name, or the only one.
  std::string region;
  std::filesystem::path mask;  ///< PNG that belongs to a PFM; empty: none.
};

struct InstalledProjector {
  std::string name;  ///< Name such as "left": the key in pages, pictures and files.
  Pinhole lens;
  RigidTransform<frame::Room, frame::Projector> T_room_projector;
  Plug plug{};
  std::optional<PjlinkPlace> pjlink{};  ///< Absent: the projector is switched by hand.
  std::optional<InstalledWarp> warp = {};
};

/// The contents of installation.toml. A value; reentrant.
struct Installation {
  std::string name;
  Wall wall;
  Point<frame::Room> sweet_spot;  ///< Position of the visitor's eye.
  std::vector<InstalledProjector> projectors;
  std::vector<std::filesystem::path> cards{};  ///< The first card renders; empty: all cards of the computer.
  std::optional<InstalledStereo> stereo{};     ///< Absent: both eyes see the same picture.

  /// Returns the smallest picture of the sweet spot that covers the wall, `width_px` wide.
  ///
  ///   one plane               perspective, on a plane tilted like the wall, unless the wall extends beyond 75 degrees
  ///   a dome                  fisheye about the dome's axis
  ///   all others              panorama. The parts of an angular wall appear in the right direction, so flat pieces
  ///                           need no picture of their own. But a fisheye if the wall extends above or below 75
  ///                           degrees, where the tangent of elevation wastes rows.
  ///
  /// With a `height_px` of 0, pixels are square; for a fisheye, the height is the width.
  [[nodiscard]] PictureShape picture(int width_px, int height_px = 0) const;
  /// Returns the panorama of the sweet spot that just covers the wall, whatever its elevation, with square pixels in
  /// the middle.
  [[nodiscard]] Panorama panorama(int width_px) const;
  /// Returns picture() for one eye, or for both eyes if there is stereo: then each eye has that many pixels, but the
  /// height is rounded up to a multiple of kCutPx.
  [[nodiscard]] Projection projection(int width_px, int height_px = 0) const;
  /// Distance from the sweet spot at which the eyes converge (Viewing::screen_distance_m) for `picture`. Exact for a
  /// plane, and for a cylinder or dome about the sweet spot. For other walls it is the inverse of the mean inverse
  /// distance, since disparity is proportional to the inverse distance.
  [[nodiscard]] double screen_distance_m(const PictureShape& picture) const;
};

/// Checks that every projector of several can be told from the others on any start: by a connector or a serial, since a
/// free connector goes to the lamp that wakes first. Errors: kInvalidArgument with the name of one that cannot.
Status check_connectors(const Installation& installation);

/// Parses HOST or HOST:PORT; the default port is that of PJLink. Errors: those of parse_address().
Result<Address> parse_projector_address(const std::string& text);

/// Reads and checks the file. A room in which a projector or the eye is not on the wall's lit side is refused. Meshes
/// and warps are files in the installation's folder; warps are not opened here. Errors: those of Config::read().
Result<Installation> read_installation(const std::filesystem::path& path);
/// Parses `text`; `name` stands for the file in errors.
Result<Installation> parse_installation(std::string_view text, std::string name,
                                        const std::filesystem::path& folder = {});

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
/// What a simulated museum really is, against what its installation.toml says. It lies beside that file, as truth.toml.
/// Only the simulation and the code that scores a calibration may know it: tests/lint/check_layers.py forbids this
/// header and that file's name to the appliance and the kiosk.
///
/// Colour inside the room is linear, in the primaries of sRGB (ITU-R BT.709): three numbers, "room colour".
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/room/installation.h"
#include "drivers/simulated/museum/true_lens.h"
#include "drivers/simulated/museum/true_response.h"
#include "drivers/simulated/museum/wall_deviation.h"

namespace cyclorama::frame {
struct Turntable;  ///< A turntable at angle 0: y along its axis, upwards; x right, z back.
}  // namespace cyclorama::frame

namespace cyclorama::simulated {

using RoomColour = std::array<double, 3>;
using ColourMatrix = std::array<RoomColour, 3>;  ///< Rows.

struct TrueProjector {
  TrueLens lens;
  RigidTransform<frame::Room, frame::Projector> T_room_projector;
  double flux_lm = 3000.0;           ///< Of a white picture.
  double vignetting_exponent = 0.0;  ///< A pixel's flux falls with this power of the cosine from the axis: 4 of an eye.
  std::array<TrueResponse, 3> response{};                     ///< Of red, green, blue.
  ColourMatrix primaries{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< Each channel's room colour, in the unit of white.
  RoomColour black{};                                         ///< The part of each channel that leaks at code 0.
  double blur_px = 0.3;  ///< Standard deviation in focus. Less than 0.41 is 0.41, a pixel's own.
  double focus_distance_m = 4.0;
  double defocus_px_per_dioptre = 0.0;
  double latency_s = 0.0;  ///< From show() to the light.
};

struct TrueCamera {
  TrueLens lens;
  double vignetting_exponent = 0.0;
  ColourMatrix sensitivity{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< Of its red, green, blue pixels to room colour.
  RoomColour grey_sensitivity{0.2126, 0.7152, 0.0722};          ///< The same camera without its colour filters.
  double electrons_per_nit_s = 3000.0;
  double full_well_e = 10000.0;
  double read_noise_e = 0.0;
  bool has_shot_noise = false;
  int bits = 12;             ///< 8 to 16.
  TrueResponse response{};   ///< Of the charge in parts of the full well.
  double pedestal = 0.0;     ///< Added to it before, so that dark noise is not cut off.
  double blur_px = 0.0;      ///< Standard deviation of the lens, besides the pixel's own square.
  double line_time_s = 0.0;  ///< From a row's exposure to the next one's; 0 is a global shutter.
};

/// Angles are positive to the right (clockwise from above), as headings are.
struct TrueTurntable {
  RigidTransform<frame::Room, frame::Turntable> T_room_turntable;  ///< Its y axis is what the turntable turns about.
  RigidTransform<frame::Turntable, frame::Camera>
      T_turntable_camera;     ///< Its translation is what the camera misses the axis by.
  double scale_error = 0.0;   ///< Turns too far by this part.
  double wobble_rad = 0.0;    ///< A sine once per turn: the gear is not round.
  double backlash_rad = 0.0;  ///< Half of it lacks in the direction of the last turn.
  double jitter_rad = 0.0;    ///< Standard deviation of each stop.
  double speed_rad_s = 0.5;
};

/// A value; reentrant.
struct MuseumTruth {
  Wall wall;
  RigidTransform<frame::Room, frame::Room> T_room_wall;  ///< Moves the wall from where its numbers say.
  WallDeviation deviation;
  RoomColour albedo{0.8, 0.8, 0.8};
  RoomColour ambient_lux{};    ///< Falls on the whole wall.
  double surround_nits = 0.0;  ///< What the camera sees beside the wall.
  int cells = 400;             ///< Of the wall, for the light that it throws at itself; 0: none.
  std::vector<TrueProjector> projectors;
  TrueCamera camera;
  TrueTurntable turntable;
  std::uint32_t seed = 1;  ///< Of the noise and the turntable's stops.

  /// A room that is what the installation says, with a perfect camera of one megapixel turning on the sweet spot.
  static MuseumTruth ideal(const Installation& installation);

  /// kBadData "truth.toml:7: ...".     Others as read_file().
  static Result<MuseumTruth> read(const std::filesystem::path& path);
  static Result<MuseumTruth> parse(std::string_view text, std::string name, const std::filesystem::path& folder = {});
  /// What parse() reads back as the same. Precondition: the wall is no mesh and its cylinder's axis is the room's.
  [[nodiscard]] std::string text() const;
};

/// Where the truth of an installation lies.
[[nodiscard]] std::filesystem::path truth_path_beside(const std::filesystem::path& installation);

}  // namespace cyclorama::simulated

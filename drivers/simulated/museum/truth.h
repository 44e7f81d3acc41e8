// SPDX-License-Identifier: Apache-2.0
/// The true state of a simulated museum, which differs from its installation.toml. It lies beside that file, as
/// truth.toml. Only the simulation and the code that scores a calibration may use it: tests/lint/check_layers.py
/// forbids this header and that file name in the appliance and the kiosk.
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
#include "drivers/simulated/museum/camera_pipeline.h"
#include "drivers/simulated/museum/true_lens.h"
#include "drivers/simulated/museum/true_response.h"
#include "drivers/simulated/museum/wall_deviation.h"
#include "drivers/simulated/museum/wall_paint.h"

namespace cyclorama::frame {
struct Turntable;  ///< A turntable at angle 0: y along its axis, upwards; x right, z back.
}  // namespace cyclorama::frame

namespace cyclorama::simulated {

using RoomColour = std::array<double, 3>;
using ColourMatrix = std::array<RoomColour, 3>;  ///< Rows.

struct TrueProjector {
  TrueLens lens;
  RigidTransform<frame::Room, frame::Projector> T_room_projector;
  double flux_lm = 3000.0;  ///< Flux of a white picture.
  /// Exponent n of cos^n(angle from the axis), by which a pixel's flux falls; 4 for a simple lens.
  double vignetting_exponent = 0.0;
  std::array<TrueResponse, 3> response{};                     ///< Red, green and blue.
  ColourMatrix primaries{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< Room colour of each channel, in units of white.
  RoomColour black{};                                         ///< Black level: light of each channel at code 0.
  double blur_px = 0.3;  ///< Standard deviation of the blur in focus; at least 0.41, a pixel's own, is applied.
  double focus_distance_m = 4.0;
  double defocus_px_per_dioptre = 0.0;
  double latency_s = 0.0;  ///< Delay from show() to the light of the picture.
  /// Enlargement of the red and the blue picture about the lens's axis, relative to the green one.
  std::array<double, 2> lateral_colour{};
  /// Light of the colour wheel's white segment, relative to white of the other segments: it is lit as far as red, green
  /// and blue have in common.
  double white_segment = 0.0;
  /// The picture's shift once the projector is warm, in its own pixels; it is cold at the museum's time 0.
  Eigen::Vector2d drift_px = Eigen::Vector2d::Zero();
  double warm_up_s = 600.0;  ///< Time after which all but 1/e of the shift is done.

  [[nodiscard]] Eigen::Vector2d drift_at(double now_s) const;
};

struct TrueCamera {
  TrueLens lens;
  double vignetting_exponent = 0.0;
  /// Response of the camera's red, green and blue pixels to room colour.
  ColourMatrix sensitivity{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  RoomColour grey_sensitivity{0.2126, 0.7152, 0.0722};  ///< Response of the same camera without colour filters.
  double electrons_per_nit_s = 3000.0;
  double full_well_e = 10000.0;
  double read_noise_e = 0.0;
  bool has_shot_noise = false;
  int bits = 12;             ///< 8 to 16.
  TrueResponse response{};   ///< Input is the charge as a fraction of the full well.
  double pedestal = 0.0;     ///< Offset added before the response, so that dark noise is not clipped.
  double blur_px = 0.0;      ///< Standard deviation of the lens blur, in addition to the pixel's own square.
  double line_time_s = 0.0;  ///< Delay between the exposures of successive rows; 0 for a global shutter.
  CameraPipeline pipeline{};
};

/// Angles are positive to the right (clockwise from above), as headings are.
struct TrueTurntable {
  /// The turntable turns about the y axis of the Turntable frame.
  RigidTransform<frame::Room, frame::Turntable> T_room_turntable;
  RigidTransform<frame::Turntable, frame::Camera>
      T_turntable_camera;     ///< The translation is the camera's offset from the axis.
  double scale_error = 0.0;   ///< Relative error of the angle; positive turns too far.
  double wobble_rad = 0.0;    ///< Amplitude of one sine period per turn, from an eccentric gear.
  double backlash_rad = 0.0;  ///< The angle falls short by half of this in the direction of the last turn.
  double jitter_rad = 0.0;    ///< Standard deviation of the angle at each stop.
  double speed_rad_s = 0.5;
  /// The mount gives way: motion of the camera's picture in an hour, and in each photograph (standard deviation).
  Eigen::Vector2d creep_px_per_h = Eigen::Vector2d::Zero();
  double vibration_px = 0.0;
};

/// A value; reentrant.
struct MuseumTruth {
  Wall wall;
  RigidTransform<frame::Room, frame::Room> T_room_wall;  ///< Displacement of the wall from its nominal pose.
  WallDeviation deviation;
  RoomColour albedo{0.8, 0.8, 0.8};
  WallPaint paint;
  RoomColour ambient_lux{};    ///< Uniform on the whole wall.
  RoomColour daylight_lux{};   ///< Largest daylight, which comes and goes; added to `ambient_lux`.
  double daylight_period_s = 600.0;
  double surround_nits = 0.0;  ///< Radiance that the camera sees beside the wall.
  int cells = 400;             ///< Number of wall cells for inter-reflection; 0 disables it.
  std::vector<TrueProjector> projectors;
  TrueCamera camera;
  TrueTurntable turntable;
  std::uint32_t seed = 1;  ///< Seed of the noise and of the turntable's stops.

  /// Light on the whole wall besides the projectors'.
  [[nodiscard]] RoomColour ambient_at(double now_s) const;
  /// The same museum with projectors that stay as they are at a time.
  [[nodiscard]] MuseumTruth warmed_up(double now_s) const;

  /// Returns a room that matches the installation exactly, with a perfect camera of one megapixel turning on the sweet
  /// spot.
  static MuseumTruth ideal(const Installation& installation);

  /// Errors: kBadData, as in "truth.toml:7: ..."; others are those of read_file().
  static Result<MuseumTruth> read(const std::filesystem::path& path);
  static Result<MuseumTruth> parse(std::string_view text, std::string name, const std::filesystem::path& folder = {});
  /// Returns text that parse() reads back unchanged. Precondition: the wall is not a mesh, and a cylinder's axis is the
  /// axis of the room.
  [[nodiscard]] std::string text() const;
};

/// Returns the path of the truth file that belongs to an installation file.
[[nodiscard]] std::filesystem::path truth_path_beside(const std::filesystem::path& installation);

}  // namespace cyclorama::simulated

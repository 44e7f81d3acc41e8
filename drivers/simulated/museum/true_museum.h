// SPDX-License-Identifier: Apache-2.0
/// Light transport in a simulated museum, and queries for scoring. Contains the truth: see truth.h for its permitted
/// users.
///
///   flux of a pixel     flux_lm / pixels * cos^n(a)                a: angle from the lens's axis
///   irradiance, lux     flux * |pixels per steradian| * cos(wall) / distance^2
///   pixels / steradian  f^2 |distortion's derivative| / cos^3(a)   where distortion enlarges, light is dimmer
///   radiance, nits      albedo / pi * (direct + indirect + ambient)
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/image/image.h"
#include "drivers/simulated/museum/inter_reflection.h"
#include "drivers/simulated/museum/true_wall.h"
#include "drivers/simulated/museum/truth.h"

namespace cyclorama::simulated {

/// A simulated museum as it really is. Immutable, hence thread-safe.
class TrueMuseum {
 public:
  /// Errors: kInvalidArgument if the wall cannot be simulated, the truth's number of projectors or picture sizes differ
  /// from the installation's, or the camera stands behind the wall.
  static Result<TrueMuseum> make(Installation installation, MuseumTruth truth);

  [[nodiscard]] const Installation& installation() const { return installation_; }
  [[nodiscard]] const MuseumTruth& truth() const { return truth_; }
  [[nodiscard]] const TrueWall& wall() const { return wall_; }

  /// Returns the wall point that a position in a projector's picture lights.
  [[nodiscard]] std::optional<TrueWall::Hit> wall_at(std::size_t projector, double u, double v) const;
  /// Returns the direction from an eye to the point of wall_at(); unit length, in the Room frame.
  [[nodiscard]] std::optional<Eigen::Vector3d> direction_at(std::size_t projector, double u, double v,
                                                            const Point<frame::Room>& eye) const;
  /// Returns the position in a projector's picture that lights a point of the wall; it may lie outside the picture.
  /// Returns nothing if no light of this projector can arrive.
  [[nodiscard]] std::optional<Eigen::Vector2d> projector_pixel(std::size_t projector, const TrueWall::Hit& at) const;

  /// Irradiance in lux for one unit of a channel's light; 0 if the light cannot arrive.
  [[nodiscard]] double gain_lux(std::size_t projector, const TrueWall::Hit& at) const;
  /// Standard deviation of a pixel's defocus blur at a point of the wall, in addition to its blur in focus.
  [[nodiscard]] double defocus_px(std::size_t projector, const TrueWall::Hit& at) const;
  /// Light of a channel for an 8-bit code, black level included, in [0, 1].
  [[nodiscard]] double channel_light(std::size_t projector, std::size_t channel, int code) const;
  /// Light of the colour wheel's white segment beside the light of the three channels.
  [[nodiscard]] double white_light(std::size_t projector, const std::array<double, 3>& channels) const;
  /// Room colour of a projector whose whole picture has this code, per unit of gain_lux().
  [[nodiscard]] RoomColour colour_of(std::size_t projector, const std::array<int, 3>& code) const;

  /// Direct irradiance of the cells by one picture, in lux: the flux of each pixel goes to the cells that it lights.
  [[nodiscard]] InterReflection::Light direct_light(std::size_t projector, const RgbImage& picture) const;
  [[nodiscard]] const WallCells& cells() const { return cells_; }
  /// Null if the truth disables inter-reflection.
  [[nodiscard]] const InterReflection* inter_reflection() const { return inter_reflection_.get(); }

  /// Radiance of a wall point, equal in all directions: linear room colour, nits. Pictures are interpolated between
  /// pixel centres, without blur. An empty picture means that the lamp is off.
  [[nodiscard]] RoomColour radiance_at(const TrueWall::Hit& at, std::span<const RgbImage> pictures) const;

  /// Returns the camera's pose for a true angle of the turntable.
  [[nodiscard]] RigidTransform<frame::Room, frame::Camera> camera_pose(double true_angle_rad) const;
  /// Returns the point about which the camera turns: the point of the turntable's axis that is nearest to the camera's
  /// centre.
  [[nodiscard]] Point<frame::Room> turning_point() const;

 private:
  /// Full-channel flux of a block of projector pixels, and the cells that receive it.
  struct Deposit {
    double flux_lm = 0.0;
    WallCells::Share share;
  };
  TrueMuseum(Installation installation, MuseumTruth truth, TrueWall wall);
  [[nodiscard]] std::vector<Deposit> deposits_of(std::size_t projector) const;

  Installation installation_;
  MuseumTruth truth_;
  TrueWall wall_;
  WallCells cells_;
  std::unique_ptr<const InterReflection> inter_reflection_;
  std::vector<std::vector<Deposit>> deposits_;  ///< Deposits of each projector, block by block.
  std::vector<std::array<std::array<double, 256>, 3>> light_of_code_;
};

}  // namespace cyclorama::simulated

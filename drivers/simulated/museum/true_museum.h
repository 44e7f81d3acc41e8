// SPDX-License-Identifier: Apache-2.0
/// What a simulated museum does with light, and what scoring asks it. Knows the truth: see truth.h for who may.
///
///   a pixel's flux      flux_lm / pixels * cos^n(a)                a: from the lens's axis
///   irradiance, lux     flux * |pixels per steradian| * cos(wall) / distance^2
///   pixels / steradian  f^2 |distortion's derivative| / cos^3(a)   what distortion spreads, it dims
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

/// Thread-safe: nothing changes once it is made.
class TrueMuseum {
 public:
  /// kInvalidArgument  the wall is none that can be simulated, the truth has another number of projectors than the
  /// installation or other pictures, or the camera stands behind the wall.
  static Result<TrueMuseum> make(Installation installation, MuseumTruth truth);

  [[nodiscard]] const Installation& installation() const { return installation_; }
  [[nodiscard]] const MuseumTruth& truth() const { return truth_; }
  [[nodiscard]] const TrueWall& wall() const { return wall_; }

  /// Where a place in a projector's picture falls on the wall.
  [[nodiscard]] std::optional<TrueWall::Hit> wall_at(std::size_t projector, double u, double v) const;
  /// The direction of that from an eye; unit length, in the Room frame.
  [[nodiscard]] std::optional<Eigen::Vector3d> direction_at(std::size_t projector, double u, double v,
                                                            const Point<frame::Room>& eye) const;
  /// Where in a projector's picture the light of a place on the wall comes from; may lie outside of it. Nothing where
  /// no light of this projector could arrive.
  [[nodiscard]] std::optional<Eigen::Vector2d> projector_pixel(std::size_t projector, const TrueWall::Hit& at) const;

  /// Irradiance for one unit of a channel's light, in lux. 0 where the light cannot arrive.
  [[nodiscard]] double gain_lux(std::size_t projector, const TrueWall::Hit& at) const;
  /// Of a pixel's blur at a place on the wall, besides what it has in focus: standard deviation.
  [[nodiscard]] double defocus_px(std::size_t projector, const TrueWall::Hit& at) const;
  /// Light of a channel for a code of 8 bits, black level included, in [0, 1].
  [[nodiscard]] double channel_light(std::size_t projector, std::size_t channel, int code) const;
  /// What a projector's whole picture would be if all of it had this code: room colour per unit of gain_lux().
  [[nodiscard]] RoomColour colour_of(std::size_t projector, const std::array<int, 3>& code) const;

  /// Direct irradiance of the cells by one picture: each pixel's flux, where it lands. Lux.
  [[nodiscard]] InterReflection::Light direct_light(std::size_t projector, const RgbImage& picture) const;
  [[nodiscard]] const WallCells& cells() const { return cells_; }
  /// Null: the truth wants none.
  [[nodiscard]] const InterReflection* inter_reflection() const { return inter_reflection_.get(); }

  /// Radiance that leaves a place on the wall towards anywhere: linear room colour, nits. Pictures are sampled between
  /// pixels' centres, without blur. An empty picture is a lamp that is off.
  [[nodiscard]] RoomColour radiance_at(const TrueWall::Hit& at, std::span<const RgbImage> pictures) const;

  /// Where the camera is when the turntable has turned to a true angle.
  [[nodiscard]] RigidTransform<frame::Room, frame::Camera> camera_pose(double true_angle_rad) const;
  /// The point of the turntable's axis that is nearest to the camera's centre: what it turns about.
  [[nodiscard]] Point<frame::Room> turning_point() const;

 private:
  /// Of a block of a projector's pixels: the flux of a full channel, and the cells that get it.
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
  std::vector<std::vector<Deposit>> deposits_;  ///< Per projector, block by block.
  std::vector<std::array<std::array<double, 256>, 3>> light_of_code_;
};

}  // namespace cyclorama::simulated

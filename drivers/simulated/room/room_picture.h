// SPDX-License-Identifier: Apache-2.0
/// A photograph of a room that does not exist: projectors light a wall, an eye looks at it.
///
///     projector pixel ── light ──▶ wall point ── diffuse ──▶ eye pixel
///                                      │
///                                      └── one bounce ──▶ floor point ──▶ eye pixel
///
/// The wall is traced from the eye: per eye pixel the wall point, per wall point the place in each projector's picture.
/// Light adds up in float, linear; nothing knows of warps or blends, so a seam that they get wrong is seen here.
/// Every projector gives the same irradiance per unit of linear light, with no distortion, vignetting or black level
/// yet.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/geometry/rigid_transform.h"
#include "common/image/image.h"
#include "common/room/installation.h"
#include "common/room/pinhole.h"

namespace cyclorama::simulated {

/// Who looks: a distortion-free camera standing in the room.
struct RoomEye {
  Pinhole lens;
  RigidTransform<frame::Room, frame::Camera> T_room_camera;

  /// A visitor's companion, some steps behind the sweet spot: sees the wall, as far as a flat picture
  /// reaches, and some of the floor.
  static RoomEye behind_visitor(const Installation& installation, int width_px, int height_px);
};

/// Where everything lies is found once; photograph() then only adds light. Thread-bound.
class RoomPicture {
 public:
  RoomPicture(Installation installation, const RoomEye& eye);

  /// One picture per projector of the installation, in its order; an empty picture is a projector that is off.
  /// Returns what the eye sees, sRGB.
  [[nodiscard]] RgbImage photograph(std::span<const RgbImage> projector_pictures) const;

  /// Radiance that leaves a wall point towards anywhere, linear; 1 is a projector's full white. For tests and scoring.
  [[nodiscard]] std::array<float, 3> radiance_at(const Point<frame::Room>& wall_point,
                                                 std::span<const RgbImage> projector_pictures) const;

 private:
  /// Where one eye pixel looks: a place in a projector's picture, or a place on the floor.
  struct Source {
    std::uint32_t eye_pixel = 0;
    std::uint32_t projector = 0;
    float u = 0.0f;
    float v = 0.0f;
  };
  struct FloorPixel {
    std::uint32_t eye_pixel = 0;
    float x = 0.0f;  ///< On the floor grid, in cells.
    float z = 0.0f;
  };
  void look_at_wall(std::uint32_t eye_pixel, const Point<frame::Room>& wall_point);
  void look_at_floor(std::uint32_t eye_pixel, const RoomRay& ray);
  void add_floor_glow(std::span<const RgbImage> projector_pictures, RadianceImage* radiance) const;

  Installation installation_;
  double reach_m_ = 1.0;  ///< The floor's grid spans [-reach, reach] both ways.
  int width_px_;
  int height_px_;
  std::vector<Source> sources_;
  std::vector<FloorPixel> floor_;
  std::vector<std::uint32_t> unlit_wall_;
};

}  // namespace cyclorama::simulated

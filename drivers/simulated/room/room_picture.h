// SPDX-License-Identifier: Apache-2.0
/// A photograph of a simulated room: projectors light a wall, and an eye looks at it.
///
///     projector pixel ── light ──▶ wall point ── diffuse ──▶ eye pixel
///                                      │
///                                      └── one bounce ──▶ floor point ──▶ eye pixel
///
/// The wall is traced from the eye: each eye pixel has a wall point, and each wall point a position in each projector's
/// picture. Light is added linearly in float; the simulation is independent of warps and blends, so that their errors
/// show as seams. Every projector gives the same irradiance per unit of linear light, without distortion, vignetting or
/// black level.
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

/// The eye: a distortion-free camera in the room.
struct RoomEye {
  Pinhole lens;
  RigidTransform<frame::Room, frame::Camera> T_room_camera;

  /// Returns an eye some steps behind the sweet spot, which sees as much of the wall as a flat picture can show, and
  /// some of the floor.
  static RoomEye behind_visitor(const Installation& installation, int width_px, int height_px);
};

/// Finds all correspondences once; photograph() then only adds light. Thread-bound.
class RoomPicture {
 public:
  RoomPicture(Installation installation, const RoomEye& eye);

  /// `projector_pictures` has one picture per projector of the installation, in its order; an empty picture means that
  /// the projector is off. Returns the eye's picture in sRGB.
  [[nodiscard]] RgbImage photograph(std::span<const RgbImage> projector_pictures) const;

  /// Linear radiance of a wall point, equal in all directions; 1 is a projector's full white. For tests and scoring.
  [[nodiscard]] std::array<float, 3> radiance_at(const Point<frame::Room>& wall_point,
                                                 std::span<const RgbImage> projector_pictures) const;

 private:
  /// The position in a projector's picture that one eye pixel sees.
  struct Source {
    std::uint32_t eye_pixel = 0;
    std::uint32_t projector = 0;
    float u = 0.0f;
    float v = 0.0f;
  };
  struct FloorPixel {
    std::uint32_t eye_pixel = 0;
    float x = 0.0f;  ///< Position on the floor grid, in cells.
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

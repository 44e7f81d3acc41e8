// SPDX-License-Identifier: Apache-2.0
/// What a camera in one pose sees of each projector: found once, so that a photograph is only light.
///
///     camera pixel ─ ray ─▶ wall ─▶ place (u, v) in each projector's picture, gain, and a footprint:
///
///        · ·     four samples about (u, v): the middles of the camera pixel's quarters carried onto the
///        · ·     projector's picture, drawn apart by the defocus at that distance
///
/// Quarters do not see the camera's own sampling frequency, so a dot's centre stays where it is to some thousandths of
/// a pixel; the 1/48 that their variance lacks of a square's 1/12 is kFootprintLack_px2, for the lens blur to add.
#pragma once

#include <cstdint>
#include <vector>

#include "drivers/simulated/museum/true_museum.h"

namespace cyclorama::simulated {

struct CameraTable {
  struct Sample {
    std::uint32_t pixel = 0;  ///< Of the camera, row by row.
    float u = 0.0f;
    float v = 0.0f;
    float uu = 0.0f;  ///< Symmetric root of the samples' covariance, in projector pixels.
    float uv = 0.0f;
    float vv = 0.0f;
    float gain_lux = 0.0f;
  };
  struct Projector {
    std::vector<Sample> samples;          ///< In the order of pixels.
    std::vector<std::size_t> row_begins;  ///< One more than rows.
  };
  /// Where a camera pixel sees the wall: the part, and the place in its grid of cells. A part below 0: beside the wall.
  struct Place {
    std::int32_t part = -1;
    float across = 0.0f;
    float along = 0.0f;
  };
  std::vector<Projector> projectors;
  std::vector<Place> positions;
};

inline constexpr double kFootprintLack_px2 = 1.0 / 48.0;

/// How many projector pixels beyond a picture's edge its blurred light still counts.
inline constexpr int kLightMargin_px = 4;

/// Directions of a camera's pixels, row by row; z is 0 where the lens has no ray.
[[nodiscard]] std::vector<Eigen::Vector3d> pixel_directions(const TrueLens& lens, int threads);

/// `directions` are those of `lens`.
[[nodiscard]] CameraTable make_camera_table(const TrueMuseum& museum, const TrueLens& lens,
                                            const RigidTransform<frame::Room, frame::Camera>& T_room_camera,
                                            const std::vector<Eigen::Vector3d>& directions, int threads);

}  // namespace cyclorama::simulated

// SPDX-License-Identifier: Apache-2.0
/// Maps each pixel of a camera in one pose to each projector's picture; computed once, so that a photograph only adds
/// light.
///
///     camera pixel ─ ray ─▶ wall ─▶ position (u, v) in each projector's picture, gain, and a footprint:
///
///        · ·     four samples about (u, v): the centres of the camera pixel's quarters mapped onto the
///        · ·     projector's picture, spread by the defocus at that distance
///
/// The quarters cancel the camera's own sampling frequency, so a dot's centre is accurate to some thousandths of a
/// pixel. Their variance is 1/16 px^2, less than the 1/12 px^2 of a square pixel. The lens blur must add the
/// difference, kFootprintLack_px2.
#pragma once

#include <cstdint>
#include <vector>

#include "drivers/simulated/museum/true_museum.h"

namespace cyclorama::simulated {

struct CameraTable {
  struct Sample {
    std::uint32_t pixel = 0;  ///< Camera pixel index, row by row.
    float u = 0.0f;
    float v = 0.0f;
    float uu = 0.0f;  ///< Symmetric square root of the samples' covariance, in projector pixels.
    float uv = 0.0f;
    float vv = 0.0f;
    float gain_lux = 0.0f;
  };
  struct Projector {
    std::vector<Sample> samples;          ///< Ordered by pixel.
    std::vector<std::size_t> row_begins;  ///< Index of each row's first sample, and the end of the last row.
  };
  /// Part of the wall that a camera pixel sees, and the position in that part's grid of cells. The part is negative if
  /// the pixel does not see the wall.
  struct Place {
    std::int32_t part = -1;
    float across = 0.0f;
    float along = 0.0f;
    float paint = 1.0f;  ///< Albedo there, relative to the wall's.
  };
  std::vector<Projector> projectors;
  std::vector<Place> positions;
};

inline constexpr double kFootprintLack_px2 = 1.0 / 48.0;

/// Width of the margin, in projector pixels, within which blurred light beyond a picture's edge counts.
inline constexpr int kLightMargin_px = 4;

/// Directions of a camera's pixels, row by row; z is 0 for a pixel without a ray.
[[nodiscard]] std::vector<Eigen::Vector3d> pixel_directions(const TrueLens& lens, int threads);

/// Precondition: `directions` are those of `lens`.
[[nodiscard]] CameraTable make_camera_table(const TrueMuseum& museum, const TrueLens& lens,
                                            const RigidTransform<frame::Room, frame::Camera>& T_room_camera,
                                            const std::vector<Eigen::Vector3d>& directions, int threads);

}  // namespace cyclorama::simulated

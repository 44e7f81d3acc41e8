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
/// pixel. Their variance is smaller than a square's 1/12 by 1/48, which is kFootprintLack_px2; the lens blur must add
/// it.
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
    std::vector<std::size_t> row_begins;  ///< Index of each row's first sample; one entry more than there are rows.
  };
  /// Wall part and position in its grid of cells that a camera pixel sees. A part below 0 means beside the wall.
  struct Place {
    std::int32_t part = -1;
    float across = 0.0f;
    float along = 0.0f;
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

// SPDX-License-Identifier: Apache-2.0
/// Predicts what a camera should see of the show:
///
///   camera pixel ─▶ wall ─▶ position in each projector's picture ─▶ its light there * gain ─▶ sum
///   └── SeenWall ──────┘└── LitPart: renewed when a pose changes ──────┘└── predict(): each picture ──┘
///
/// The gain is the irradiance's geometric factor; the rest (lamps, vignetting, paint, ambient light) is smooth, and the
/// comparison estimates it per patch (patch_alignment.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "appliance/calibration/show_calibration.h"
#include "appliance/healing/estimator/light_plane.h"

namespace cyclorama::healing {

/// Ray slopes of the pixels of a camera's reduced picture, computed once. NaN where the lens has none.
struct CameraSlopes {
  int factor = 1;
  int width = 0;
  int height = 0;
  std::vector<Eigen::Vector2f> slopes;
};
[[nodiscard]] CameraSlopes camera_slopes(const calibration::ShowCamera& camera, int factor);

/// Point of the wall, in the Room frame, and its normal for each camera pixel; NaN beside the wall.
struct SeenWall {
  int width = 0;
  int height = 0;
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
};
[[nodiscard]] SeenWall seen_wall(const Wall& wall, const calibration::ShowCamera& camera, const CameraSlopes& slopes);

/// Position in one projector's picture, in its pixels, for each camera pixel; gain 0 where the projector gives no
/// light.
struct LitPart {
  struct Place {
    float u = 0.0f;
    float v = 0.0f;
    float gain = 0.0f;
  };
  std::vector<Place> positions;
  int first_row = 0;  ///< First row with light; end_row is after the last.
  int end_row = 0;
  bool is_placed = true;  ///< False if the position of the projector's light is too uncertain.
};
[[nodiscard]] LitPart lit_part(const SeenWall& seen, const calibration::ShowProjector& projector);
/// Returns the median number of a projector's pixels per pixel of the camera; 1 if the projector lights no pixel.
[[nodiscard]] double footprint_px(const SeenWall& seen, const LitPart& lit);

/// Values of Prediction::owner for pixels that no projector owns.
inline constexpr std::int8_t kUnlit = -1;
inline constexpr std::int8_t kOverlap = -2;
inline constexpr std::int8_t kBesideWall = -3;
/// A projector owns a pixel if at least this share of the pixel's light is its light.
inline constexpr float kOwnShare = 0.85f;

struct Prediction {
  LightPlane light;             ///< The predicted light, after soften().
  Image<std::int8_t, 1> owner;  ///< Index of a projector, or kUnlit, kOverlap or kBesideWall.
};
/// Predicts one picture. `lit` and `shone` have one element per projector; a plane without pixels stands for a lamp
/// that is off.
[[nodiscard]] Prediction predict(const SeenWall& seen, std::span<const LitPart> lit, std::span<const LightPlane> shone,
                                 int factor);

}  // namespace cyclorama::healing

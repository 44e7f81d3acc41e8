// SPDX-License-Identifier: Apache-2.0
/// What a camera should see of the show:
///
///   camera pixel ─▶ wall ─▶ place in each projector's picture ─▶ its light there * gain ─▶ sum
///   └── SeenWall ──────┘└── LitPart: made anew when a pose changes ──┘└── predict(): each picture ──┘
///
/// The gain is what geometry says of the irradiance; what it leaves out (lamps, vignetting, paint, ambient light) is
/// smooth, and each patch finds it for itself when it is compared.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "appliance/calibration/show_calibration.h"
#include "appliance/healing/estimator/light_plane.h"

namespace cyclorama::healing {

/// The slopes of a camera's pixels at a reduced size: made once. NaN where the lens has none.
struct CameraSlopes {
  int factor = 1;
  int width = 0;
  int height = 0;
  std::vector<Eigen::Vector2f> slopes;
};
[[nodiscard]] CameraSlopes camera_slopes(const calibration::ShowCamera& camera, int factor);

/// Per camera pixel a place on the wall, in the Room frame, and which way it faces; NaN beside the wall.
struct SeenWall {
  int width = 0;
  int height = 0;
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
};
[[nodiscard]] SeenWall seen_wall(const Wall& wall, const calibration::ShowCamera& camera, const CameraSlopes& slopes);

/// Per camera pixel the place in one projector's picture, in its pixels; gain 0 where it gives no light.
struct LitPart {
  struct Place {
    float u = 0.0f;
    float v = 0.0f;
    float gain = 0.0f;
  };
  std::vector<Place> positions;
  int first_row = 0;  ///< Rows with light.
  int end_row = 0;
  bool is_placed = true;  ///< Or nobody knows well enough where it lands.
};
[[nodiscard]] LitPart lit_part(const SeenWall& seen, const calibration::ShowProjector& projector);
/// How many of a projector's pixels lie beneath one of the camera's, on the median; 1 if it lights none.
[[nodiscard]] double footprint_px(const SeenWall& seen, const LitPart& lit);

/// Whose light a pixel is.
inline constexpr std::int8_t kUnlit = -1;
inline constexpr std::int8_t kOverlap = -2;
inline constexpr std::int8_t kBesideWall = -3;
/// One projector owns a pixel if this part of its light, or more, is its.
inline constexpr float kOwnShare = 0.85f;

struct Prediction {
  LightPlane light;             ///< Softened.
  Image<std::int8_t, 1> owner;  ///< A projector, or one of the above.
};
/// One of each per projector; a plane without pixels is a lamp that is off.
[[nodiscard]] Prediction predict(const SeenWall& seen, std::span<const LitPart> lit, std::span<const LightPlane> shone,
                                 int factor);

}  // namespace cyclorama::healing

// SPDX-License-Identifier: Apache-2.0
/// The rays of a picture, in float and many at once: what projection.h says in double.
///
/// A direction is off by less than 1/100 pixel in pictures up to 16384 pixels wide, or by less than 3e-7 radians where
/// a pixel is narrower than 3e-5. The same bits on every machine, whatever the batch: only operations that IEEE 754
/// rounds correctly, never contracted.
#pragma once

#include <cstdint>

#include "common/geometry/projection.h"
#include "renderfarm/render/vectors.h"

namespace cyclorama {

/// Where Camera writes: arrays of as many elements as there are rays, none overlapping. Borrowed.
struct CameraRays {
  float* origin_x = nullptr;  ///< Metres from the eye, render frame.
  float* origin_y = nullptr;
  float* origin_z = nullptr;
  float* direction_x = nullptr;  ///< Unit length to 6e-7, render frame.
  float* direction_y = nullptr;
  float* direction_z = nullptr;
  float* cone = nullptr;           ///< Radians between neighbouring pixels there, along the side where that is more.
  std::uint8_t* exists = nullptr;  ///< 0: outside of a fisheye's circle, where origin, direction and cone mean nothing.
};

struct CameraRay {
  Vec3 origin = Vec3::Zero();
  Vec3 direction = -Vec3::UnitZ();
  float cone = 0.0f;
};

/// One picture's rays. A value; reentrant.
class Camera {
 public:
  /// A panorama of one pixel.
  Camera();
  /// Precondition: projection.validate(). The heading is that of the Eye frame in the render frame.
  Camera(const Projection& projection, double heading_rad);

  /// False: all origins are zero.
  [[nodiscard]] bool moves_eye() const { return s_.moves; }
  /// False: every pixel has a ray.
  [[nodiscard]] bool leaves_out_pixels() const { return s_.kind == Kind::kFisheye; }

  /// The rays of `count` places of the whole picture, in pixels. Returns how many exist.
  int rays(int count, const float* x, const float* y, const CameraRays& ret) const;
  /// One of them, the same bits. False if it does not exist.
  bool ray(float x, float y, CameraRay* ret) const;

  /// All that the loops need.
  enum class Kind { kPanorama, kPerspective, kFisheye, kEquirectangular };
  struct Setup {
    Kind kind = Kind::kPanorama;
    bool moves = false;
    // Pixels from the picture's middle, times this, plus that: half the azimuth and the tangent of elevation; two
    // tangents; half the angle from the axis, right and up; half the azimuth and half the elevation.
    float middle_x = 0.5f, middle_y = 0.5f;
    float scale_x = 1.0f, scale_y = 1.0f;
    float offset_x = 0.0f, offset_y = 0.0f;
    float cone_x = 1.0f, cone_y = 1.0f;           ///< Radians per pixel where the picture is not foreshortened.
    float radius2_px = 0.0f;                      ///< Fisheye.
    float turn[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< From the picture's axes to the render frame, by rows.
    // Only if `moves`.
    float viewer[3] = {0, 0, 0};
    float upper_side = 0.0f, lower_side = 0.0f;  ///< Metres to the right of the viewer, above and below `seam_y`.
    float seam_y = 0.0f;
    float seam_height = 0.0f;    ///< What is taken off y below the seam.
    float nearness = 0.0f;       ///< 1 / screen distance.
    float right[3] = {1, 0, 0};  ///< Perspective.
    float pole_fade = 0.0f;      ///< Spheres: the horizontal length below which the eyes come together.
  };

 private:
  Setup s_;
};

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
/// Camera rays of a picture, in float and in batches: the counterpart of projection.h, which uses double.
///
/// The error of a direction is less than 1/100 pixel in pictures up to 16384 pixels wide, or less than 3e-7 radians
/// where a pixel is narrower than 3e-5. Results are bit-identical on every machine and for every batch: only operations
/// that IEEE 754 rounds correctly are used, and they are never contracted.
#pragma once

#include <cstdint>

#include "common/geometry/projection.h"
#include "renderfarm/render/vectors.h"

namespace cyclorama::render {

/// Output arrays of Camera, with as many elements as there are rays; they must not overlap. Borrowed.
struct CameraRays {
  float* origin_x = nullptr;  ///< Metres from the eye, render frame.
  float* origin_y = nullptr;
  float* origin_z = nullptr;
  float* direction_x = nullptr;  ///< Unit length to 6e-7, render frame.
  float* direction_y = nullptr;
  float* direction_z = nullptr;
  float* cone = nullptr;  ///< Radians between neighbouring pixels at this one, along the axis for which it is larger.
  std::uint8_t* exists = nullptr;  ///< 0 outside a fisheye's circle, where origin, direction and cone are undefined.
};

struct CameraRay {
  Vec3 origin = Vec3::Zero();
  Vec3 direction = -Vec3::UnitZ();
  float cone = 0.0f;
};

/// The rays of one picture. A value; reentrant.
class RayCamera {
 public:
  /// Creates the camera of a panorama of one pixel.
  RayCamera();
  /// Precondition: projection.validate(). `heading_rad` is the heading of the Eye frame in the render frame.
  RayCamera(const Projection& projection, double heading_rad);

  /// False if all origins are zero.
  [[nodiscard]] bool moves_eye() const { return s_.moves; }
  /// False if every pixel has a ray.
  [[nodiscard]] bool leaves_out_pixels() const { return s_.kind == Kind::kFisheye; }

  /// Computes the rays of `count` positions in the whole picture, in pixels. Returns how many of them exist.
  int rays(int count, const float* x, const float* y, const CameraRays& ret) const;
  /// Computes a single ray, bit-identical to that of rays(). Returns false if it does not exist.
  bool ray(float x, float y, CameraRay* ret) const;

  /// Parameters of the loops over rays.
  enum class Kind { kPanorama, kPerspective, kFisheye, kEquirectangular };
  struct Setup {
    Kind kind = Kind::kPanorama;
    bool moves = false;
    // Factor and offset for pixels measured from the picture's middle. They yield, by kind: half the azimuth and the
    // tangent of elevation; two tangents; half the angle from the axis, right and up; half the azimuth and half the
    // elevation.
    float middle_x = 0.5f, middle_y = 0.5f;
    float scale_x = 1.0f, scale_y = 1.0f;
    float offset_x = 0.0f, offset_y = 0.0f;
    float cone_x = 1.0f, cone_y = 1.0f;           ///< Radians per pixel where the picture is not foreshortened.
    float radius2_px = 0.0f;                      ///< Fisheye.
    float turn[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< Rotation from the picture's axes to the render frame, row by row.
    // Used only if `moves`.
    float viewer[3] = {0, 0, 0};
    float upper_side = 0.0f, lower_side = 0.0f;  ///< Metres to the right of the viewer, above and below `seam_y`.
    float seam_y = 0.0f;
    float seam_height = 0.0f;       ///< Subtracted from y below the seam, in pixels.
    float inverse_screen_m = 0.0f;  ///< 1 / screen distance.
    float right[3] = {1, 0, 0};     ///< Perspective only.
    float pole_fade = 0.0f;         ///< Full spheres: horizontal length of a direction below which the eyes converge.
  };

 private:
  Setup s_;
};

}  // namespace cyclorama::render

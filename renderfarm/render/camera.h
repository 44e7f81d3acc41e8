// SPDX-License-Identifier: Apache-2.0
/// Camera rays of a picture, in float and in batches: the counterpart of projection.h, which uses double.
///
/// The error of a direction is less than 1/100 pixel in pictures up to 16384 pixels wide, or less than 3e-7 radians
/// where a pixel spans less than 3e-5 radians. Results are bit-identical on every machine and for every batch: only
/// operations that IEEE 754 rounds correctly are used, and they are never contracted.
#pragma once

#include <cstdint>

#include "common/geometry/projection.h"
#include "renderfarm/render/vectors.h"

namespace cyclorama::render {

/// Output arrays of RayCamera::rays(), with one element for each ray; they must not overlap. Borrowed.
struct CameraRays {
  float* origin_x = nullptr;  ///< Metres from the eye, render frame.
  float* origin_y = nullptr;
  float* origin_z = nullptr;
  float* direction_x = nullptr;  ///< Unit length within 6e-7; render frame.
  float* direction_y = nullptr;
  float* direction_z = nullptr;
  float* cone = nullptr;           ///< Angle to the next pixel, in radians, along the axis for which it is larger.
  std::uint8_t* exists = nullptr;  ///< 0 outside a fisheye's circle, where origin, direction and cone are undefined.
};

struct CameraRay {
  Vec3 origin = Vec3::Zero();
  Vec3 direction = -Vec3::UnitZ();
  float cone = 0.0f;
};

/// The camera rays of one picture. A value; reentrant.
class RayCamera {
 public:
  /// Creates the camera of a panorama of one pixel.
  RayCamera();
  /// Precondition: projection.validate() succeeds. `heading_rad` is the heading of the Eye frame in the render frame.
  RayCamera(const Projection& projection, double heading_rad);

  /// Returns true if the origin of any ray differs from zero.
  [[nodiscard]] bool moves_eye() const { return s_.moves; }
  /// Returns true if some pixels may have no ray.
  [[nodiscard]] bool leaves_out_pixels() const { return s_.kind == Kind::kFisheye; }

  /// Computes the rays of `count` positions, which are in pixels of the whole picture. Returns the number of rays that
  /// exist.
  int rays(int count, const float* x, const float* y, const CameraRays& ret) const;
  /// Computes a single ray, bit-identical to that of rays(). Returns false if it does not exist.
  bool ray(float x, float y, CameraRay* ret) const;

  /// Shape of the picture.
  enum class Kind { kPanorama, kPerspective, kFisheye, kEquirectangular };
  /// Parameters of the loops over rays.
  struct Setup {
    Kind kind = Kind::kPanorama;
    bool moves = false;
    // Scale and offset that convert pixels, measured from the picture's middle, to the coordinates of each kind.
    // Panorama: half the azimuth and the tangent of the elevation. Perspective: two tangents. Fisheye: half the angle
    // from the axis, to the right and upwards. Equirectangular: half the azimuth and half the elevation.
    float middle_x = 0.5f, middle_y = 0.5f;
    float scale_x = 1.0f, scale_y = 1.0f;
    float offset_x = 0.0f, offset_y = 0.0f;
    float cone_x = 1.0f, cone_y = 1.0f;           ///< Radians per pixel where the picture is not foreshortened.
    float radius2_px = 0.0f;                      ///< Squared radius of a fisheye's circle.
    float turn[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< Rotation from the picture's axes to the render frame, row by row.
    // Used only if `moves`.
    float viewer[3] = {0, 0, 0};
    /// Offset of the eye to the viewer's right, in metres, above and below `seam_y`.
    float upper_side = 0.0f, lower_side = 0.0f;
    float seam_y = 0.0f;
    float seam_height = 0.0f;       ///< Subtracted from y below the seam, in pixels.
    float inverse_screen_m = 0.0f;  ///< 1 / screen distance.
    float right[3] = {1, 0, 0};     ///< Direction to the right; used only for perspective pictures.
    /// Horizontal length of a unit direction below which the two eyes converge; for full spheres.
    float pole_fade = 0.0f;
  };

 private:
  Setup s_;
};

}  // namespace cyclorama::render

// SPDX-License-Identifier: Apache-2.0
/// Mapping from a picture's pixels to lines of sight: the shape of the picture, the screen that it is shown on, and the
/// eye that looks at it.
///
/// Frame: the Eye frame (x right, y up, the heading along -z), with its origin at the sweet spot. The centre of the
/// first pixel is (0.5, 0.5), as in panorama.h. Everything here is a value in double; reentrant.
/// renderfarm/render/camera.h computes the same rays in float, many at once.
///
/// One rule determines every eye's picture: the pixel lies on the screen, and the eye looks through it.
///
///     cylinder  S = R (sin a, t, -cos a)     panorama                        . ' S ' .
///     plane     S = R (p, q, -1), tilted     perspective                   /    / \    \      a point on the screen
///     sphere    S = R d                      fisheye, equirectangular         left right      has no disparity
#pragma once

#include <Eigen/Core>
#include <limits>
#include <numbers>
#include <optional>
#include <variant>

#include "common/base/result.h"
#include "common/geometry/panorama.h"

namespace cyclorama {

/// Perspective picture for a flat screen, given by the tangents of the angles from the picture's axis to its edges; in
/// a centred picture, the left and the lower tangents are negative. Any rectangle of the plane is possible (off-axis).
struct Perspective {
  int width_px = 0;
  int height_px = 0;
  double tan_left = 0.0;
  double tan_right = 0.0;
  double tan_top = 0.0;
  double tan_bottom = 0.0;
  double tilt_rad = 0.0;  ///< Angle of the axis above the horizon.

  /// Returns a centred picture with square pixels.
  static Perspective from_field(int width_px, int height_px, double field_rad, double tilt_rad);
  friend bool operator==(const Perspective&, const Perspective&) = default;
};

/// Equidistant fisheye, the picture of a dome: the angle from the axis is proportional to the distance from the
/// picture's centre, up to the largest circle in the picture. Pixels outside the circle are empty. Tilted by a quarter
/// turn it is a dome master, with the zenith in the middle and the heading at the lower edge.
struct Fisheye {
  int width_px = 0;
  int height_px = 0;
  double field_rad = std::numbers::pi;  ///< Angle across the circle; at most 2 pi.
  double tilt_rad = 0.0;                ///< Angle of the axis above the horizon.

  [[nodiscard]] double radius_px() const { return 0.5 * (width_px < height_px ? width_px : height_px); }
  [[nodiscard]] double radians_per_px() const { return 0.5 * field_rad / radius_px(); }
  friend bool operator==(const Fisheye&, const Fisheye&) = default;
};

/// Picture with azimuth across and elevation down, both linear.
struct Equirectangular {
  int width_px = 0;
  int height_px = 0;
  double azimuth_span_rad = 2.0 * std::numbers::pi;  ///< Whole width; azimuth 0 is the middle.
  double elevation_top_rad = 0.5 * std::numbers::pi;
  double elevation_bottom_rad = -0.5 * std::numbers::pi;
  friend bool operator==(const Equirectangular&, const Equirectangular&) = default;
};

using PictureShape = std::variant<Panorama, Perspective, Fisheye, Equirectangular>;

[[nodiscard]] int width_px(const PictureShape& shape);
[[nodiscard]] int height_px(const PictureShape& shape);
/// Errors: kInvalidArgument, with the field's name, unless there are 1 to 16384 pixels each way, all values are finite,
/// and each is in the range stated above.
[[nodiscard]] Status validate(const PictureShape& shape);

/// Returns S / R above, the direction of a pixel from an eye at the sweet spot; empty outside a fisheye's circle.
[[nodiscard]] std::optional<Eigen::Vector3d> direction_at(const PictureShape& shape, PanoramaPixel p);
/// Inverse of direction_at(), also for positive multiples; the result may lie outside the picture. Empty where no pixel
/// of an unbounded picture shows the direction: straight up in a panorama, behind a plane, outside a fisheye's field.
[[nodiscard]] std::optional<PanoramaPixel> pixel_of(const PictureShape& shape, const Eigen::Vector3d& direction);

enum class Eyes {
  kMono,      ///< One eye, in the middle between the two.
  kLeft,      ///< Left eye.
  kRight,     ///< Right eye.
  kOverUnder  ///< Both in one picture of twice the shape's height, the left eye's above.
};

/// Eyes and screen. On a flat screen the eyes are side by side. On a round screen, every column is drawn for eyes that
/// face it (omnistereo: both eyes lie on a circle around the viewer), so that the picture is right wherever the visitor
/// looks. Sources: Peleg, Ben-Ezra and Pritch, "Omnistereo: Panoramic Stereo Imaging", PAMI 23(3), 2001; for domes
/// Bourke, "Omni-directional Stereoscopic Fisheye Images", CGAT 2009.
struct Viewing {
  Eyes eyes = Eyes::kMono;
  double eye_distance_m = 0.0;  ///< Distance between the pupils; about 0.063 for adults.
  /// Distance from the sweet spot to the screen: radius of a cylinder or dome, distance of a plane along its axis. The
  /// eyes converge there. Infinite: they look in parallel.
  double screen_distance_m = std::numeric_limits<double>::infinity();
  Eigen::Vector3d viewer_m = Eigen::Vector3d::Zero();  ///< Position midway between the eyes; the screen stays.
  /// On a sphere, the eyes' distance decreases to zero within this angle of zenith and nadir, where left and right are
  /// undefined; 0 is plain omnistereo, which is discontinuous there.
  double pole_fade_rad = std::numbers::pi / 6.0;
  friend bool operator==(const Viewing&, const Viewing&) = default;
};

struct EyeRay {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();       ///< Metres from the sweet spot.
  Eigen::Vector3d direction = -Eigen::Vector3d::UnitZ();  ///< Unit length.
};

/// A picture's shape and its viewer.
struct Projection {
  PictureShape shape = Panorama{};
  Viewing viewing;

  /// Number of pictures, one above another; 2 with both eyes.
  [[nodiscard]] int stacked() const { return viewing.eyes == Eyes::kOverUnder ? 2 : 1; }
  /// Size of the whole picture, which contains both eyes' pictures if there are two.
  [[nodiscard]] int width_px() const { return cyclorama::width_px(shape); }
  [[nodiscard]] int height_px() const;
  /// Errors: kInvalidArgument, with the field's name, unless the shape is valid, the whole picture has at most 16384
  /// pixels each way, and both eyes are in front of the screen.
  [[nodiscard]] Status validate() const;
  /// Returns the ray of pixel p of the whole picture; empty outside a fisheye's circle. Precondition: validate()
  /// succeeds.
  [[nodiscard]] std::optional<EyeRay> ray_at(PanoramaPixel p) const;
  friend bool operator==(const Projection&, const Projection&) = default;
};

}  // namespace cyclorama

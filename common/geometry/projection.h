// SPDX-License-Identifier: Apache-2.0
/// How the pixels of a picture become lines of sight: the shape of the picture, the screen that it is shown on, and the
/// eye that looks at it.
///
/// Frame: the Eye frame (x right, y up, the heading along -z), its origin at the sweet spot. Pixels as in panorama.h:
/// the centre of the first is (0.5, 0.5). Everything here is a value in double; reentrant. renderfarm/render/camera.h
/// makes the same rays in float, many at once.
///
/// One rule gives every eye its picture: the pixel lies somewhere on the screen, and the eye looks through it.
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

/// Straight lines stay straight: a flat screen. Tangents of the angles from the picture's axis to its edges, the left
/// and the lower one negative in a centred picture; any rectangle of the plane is possible (off-axis).
struct Perspective {
  int width_px = 0;
  int height_px = 0;
  double tan_left = 0.0;
  double tan_right = 0.0;
  double tan_top = 0.0;
  double tan_bottom = 0.0;
  double tilt_rad = 0.0;  ///< Of the axis above the horizon.

  /// Centred, square pixels.
  static Perspective from_field(int width_px, int height_px, double field_rad, double tilt_rad);
  friend bool operator==(const Perspective&, const Perspective&) = default;
};

/// Equidistant fisheye, a dome's picture: the angle from the axis grows evenly from the picture's middle to the largest
/// circle in it. Pixels outside of the circle see nothing. Tilted by a quarter turn it is a dome master: the zenith in
/// the middle, the heading at the lower edge.
struct Fisheye {
  int width_px = 0;
  int height_px = 0;
  double field_rad = std::numbers::pi;  ///< Across the circle, at most 2 pi.
  double tilt_rad = 0.0;                ///< Of the axis above the horizon.

  [[nodiscard]] double radius_px() const { return 0.5 * (width_px < height_px ? width_px : height_px); }
  [[nodiscard]] double radians_per_px() const { return 0.5 * field_rad / radius_px(); }
  friend bool operator==(const Fisheye&, const Fisheye&) = default;
};

/// Azimuth across, elevation down, both evenly.
struct Equirectangular {
  int width_px = 0;
  int height_px = 0;
  double azimuth_span_rad = 2.0 * std::numbers::pi;  ///< Azimuth 0 is the middle.
  double elevation_top_rad = 0.5 * std::numbers::pi;
  double elevation_bottom_rad = -0.5 * std::numbers::pi;
  friend bool operator==(const Equirectangular&, const Equirectangular&) = default;
};

using PictureShape = std::variant<Panorama, Perspective, Fisheye, Equirectangular>;

[[nodiscard]] int width_px(const PictureShape& shape);
[[nodiscard]] int height_px(const PictureShape& shape);
/// kInvalidArgument, naming the field: 1 to 16384 pixels each way, all finite, and the ranges said above.
[[nodiscard]] Status validate(const PictureShape& shape);

/// S / R above: what the pixel shows to an eye in the sweet spot. Nothing outside of a fisheye's circle.
[[nodiscard]] std::optional<Eigen::Vector3d> direction_at(const PictureShape& shape, PanoramaPixel p);
/// The inverse, for any positive multiple; it may lie outside of the picture. Nothing where no pixel of an endless
/// picture would show it: straight up in a panorama, behind a plane, outside of a fisheye's field.
[[nodiscard]] std::optional<PanoramaPixel> pixel_of(const PictureShape& shape, const Eigen::Vector3d& direction);

enum class Eyes {
  kMono,      ///< One, between the two.
  kLeft,      ///< The left one.
  kRight,     ///< The right one.
  kOverUnder  ///< Both in one picture of twice the shape's height: the left eye's above.
};

/// Who looks at which screen. On a flat screen the eyes are side by side. On a round one every column is drawn for eyes
/// that face it (omnistereo: both lie on a circle around the viewer), so that the picture is right wherever the visitor
/// looks. Source: Peleg, Ben-Ezra and Pritch, "Omnistereo: Panoramic Stereo Imaging", PAMI 23(3), 2001; for domes
/// Bourke, "Omni-directional Stereoscopic Fisheye Images", CGAT 2009.
struct Viewing {
  Eyes eyes = Eyes::kMono;
  double eye_distance_m = 0.0;  ///< Between the pupils; people have about 0.063.
  /// From the sweet spot to the screen: radius of cylinder or dome, distance of a plane along its axis. The eyes
  /// converge there. Infinite: they look in parallel.
  double screen_distance_m = std::numeric_limits<double>::infinity();
  Eigen::Vector3d viewer_m = Eigen::Vector3d::Zero();  ///< Where the viewer is, between the eyes; the screen stays.
  /// On a sphere, the eyes come together within this angle of zenith and nadir, where no side is left or right; 0 is
  /// plain omnistereo, torn there.
  double pole_fade_rad = std::numbers::pi / 6.0;
  friend bool operator==(const Viewing&, const Viewing&) = default;
};

struct EyeRay {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();       ///< Metres from the sweet spot.
  Eigen::Vector3d direction = -Eigen::Vector3d::UnitZ();  ///< Unit length.
};

/// A picture's shape, and who looks at it.
struct Projection {
  PictureShape shape = Panorama{};
  Viewing viewing;

  /// How many pictures of the shape it has, one above another: 2 with both eyes.
  [[nodiscard]] int stacked() const { return viewing.eyes == Eyes::kOverUnder ? 2 : 1; }
  /// Of the whole picture: with both eyes, if it shows both.
  [[nodiscard]] int width_px() const { return cyclorama::width_px(shape); }
  [[nodiscard]] int height_px() const;
  /// kInvalidArgument, naming the field: a valid shape, a picture of at most 16384 pixels each way, and both eyes in
  /// front of the screen.
  [[nodiscard]] Status validate() const;
  /// Of pixel p of the whole picture; nothing outside of a fisheye's circle. Precondition: validate().
  [[nodiscard]] std::optional<EyeRay> ray_at(PanoramaPixel p) const;
  friend bool operator==(const Projection&, const Projection&) = default;
};

}  // namespace cyclorama

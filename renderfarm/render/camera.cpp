// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/camera.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/base/check.h"
#include "common/base/vector_clones.h"

namespace cyclorama::render {
namespace {

using Setup = RayCamera::Setup;
using Kind = RayCamera::Kind;

#define CYCLORAMA_INLINE [[gnu::always_inline]] inline

// The next two functions are polynomials through the Chebyshev nodes of [0, (pi/2)^2] with the constant fixed at 1;
// their maximum errors are 2.6e-8 and 5.6e-9.

/// Returns sin(a) / a for |a| <= pi/2, given a^2.
CYCLORAMA_INLINE float sine_over_angle(float a2) {
  return 1.0f + a2 * (-0x1.555554p-3f + a2 * (0x1.11104ep-7f + a2 * (-0x1.9fb686p-13f + a2 * 0x1.61a18ap-19f)));
}
/// Returns cos(a) for |a| <= pi/2, given a^2.
CYCLORAMA_INLINE float cosine(float a2) {
  return 1.0f +
         a2 * (-0.5f + a2 * (0x1.555552p-5f + a2 * (-0x1.6c152ap-10f + a2 * (0x1.9fa602p-16f + a2 * -0x1.1a5e1p-22f))));
}

struct Turned {
  float sine;
  float cosine;
};
/// Returns sine and cosine of twice `half`, |half| <= pi/2. Small angles keep their relative precision.
CYCLORAMA_INLINE Turned turned_by_twice(float half) {
  const float half2 = half * half;
  const float s = half * sine_over_angle(half2);
  return {2.0f * s * cosine(half2), 1.0f - 2.0f * s * s};
}

/// The direction of a pixel for an eye in the sweet spot, in the picture's axes; not normalised.
struct Seen {
  float x;
  float y;
  float z;
  float length;
  float cone;
};

template <Kind kKind>
CYCLORAMA_INLINE Seen seen_at(const Setup& s, float x, float y) {
  const float across = (x - s.middle_x) * s.scale_x + s.offset_x;
  const float down = (y - s.middle_y) * s.scale_y + s.offset_y;
  if constexpr (kKind == Kind::kPanorama) {
    const Turned azimuth = turned_by_twice(across);
    const float length = std::sqrt(1.0f + down * down);
    const float inverse = 1.0f / length;
    return {azimuth.sine, down, -azimuth.cosine, length, inverse * std::max(s.cone_x, s.cone_y * inverse)};
  } else if constexpr (kKind == Kind::kPerspective) {
    const float length = std::sqrt(1.0f + across * across + down * down);
    return {across, down, -1.0f, length, std::max(s.cone_x, s.cone_y) / length};
  } else if constexpr (kKind == Kind::kFisheye) {
    const float half2 = across * across + down * down;
    const float sine = sine_over_angle(half2);
    const float sideways = 2.0f * sine * cosine(half2);
    return {sideways * across, sideways * down, 2.0f * half2 * sine * sine - 1.0f, 1.0f, s.cone_x};
  } else {
    const Turned azimuth = turned_by_twice(across);
    const Turned elevation = turned_by_twice(down);
    return {elevation.cosine * azimuth.sine, elevation.sine, -(elevation.cosine * azimuth.cosine), 1.0f,
            std::max(s.cone_x * elevation.cosine, s.cone_y)};
  }
}

/// The arrays are separate parameters, because after inlining `__restrict__` takes effect only on parameters, and
/// nothing is vectorised without it.
template <Kind kKind, bool kMoves>
CYCLORAMA_INLINE void trace(const Setup s, int count, const float* __restrict__ in_x, const float* __restrict__ in_y,
                            float* __restrict__ origin_x, float* __restrict__ origin_y, float* __restrict__ origin_z,
                            float* __restrict__ direction_x, float* __restrict__ direction_y,
                            float* __restrict__ direction_z, float* __restrict__ cone) {
  for (int i = 0; i < count; ++i) {
    const bool lower = in_y[i] >= s.seam_y;
    const Seen seen = seen_at<kKind>(s, in_x[i], in_y[i] - (lower ? s.seam_height : 0.0f));
    const float x = s.turn[0] * seen.x + s.turn[1] * seen.y + s.turn[2] * seen.z;
    const float y = s.turn[3] * seen.x + s.turn[4] * seen.y + s.turn[5] * seen.z;
    const float z = s.turn[6] * seen.x + s.turn[7] * seen.y + s.turn[8] * seen.z;
    if constexpr (!kMoves) {
      const float inverse = 1.0f / seen.length;
      direction_x[i] = x * inverse;
      direction_y[i] = y * inverse;
      direction_z[i] = z * inverse;
      cone[i] = seen.cone;
      origin_x[i] = 0.0f;
      origin_y[i] = 0.0f;
      origin_z[i] = 0.0f;
    } else {
      float side = lower ? s.lower_side : s.upper_side;
      float eye_x = 0.0f;
      float eye_y = s.viewer[1];
      float eye_z = 0.0f;
      if constexpr (kKind == Kind::kPerspective) {
        eye_x = s.viewer[0] + side * s.right[0];
        eye_z = s.viewer[2] + side * s.right[2];
      } else {
        if constexpr (kKind != Kind::kPanorama) side /= std::max(std::sqrt(x * x + z * z), s.pole_fade);
        eye_x = s.viewer[0] - side * z;
        eye_z = s.viewer[2] + side * x;
      }
      const float to_x = x - eye_x * s.inverse_screen_m;
      const float to_y = y - eye_y * s.inverse_screen_m;
      const float to_z = z - eye_z * s.inverse_screen_m;
      const float inverse = 1.0f / std::sqrt(to_x * to_x + to_y * to_y + to_z * to_z);
      direction_x[i] = to_x * inverse;
      direction_y[i] = to_y * inverse;
      direction_z[i] = to_z * inverse;
      cone[i] = seen.cone * (seen.length * inverse);
      origin_x[i] = eye_x;
      origin_y[i] = eye_y;
      origin_z[i] = eye_z;
    }
  }
}

template <Kind kKind>
CYCLORAMA_INLINE void trace(const Setup& s, int count, const float* x, const float* y, const CameraRays& to) {
  if (s.moves) {
    trace<kKind, true>(s, count, x, y, to.origin_x, to.origin_y, to.origin_z, to.direction_x, to.direction_y,
                       to.direction_z, to.cone);
  } else {
    trace<kKind, false>(s, count, x, y, to.origin_x, to.origin_y, to.origin_z, to.direction_x, to.direction_y,
                        to.direction_z, to.cone);
  }
}

CYCLORAMA_VECTOR_CLONES
void trace_panorama(const Setup& s, int count, const float* x, const float* y, const CameraRays& ret) {
  trace<Kind::kPanorama>(s, count, x, y, ret);
}
CYCLORAMA_VECTOR_CLONES
void trace_perspective(const Setup& s, int count, const float* x, const float* y, const CameraRays& ret) {
  trace<Kind::kPerspective>(s, count, x, y, ret);
}
CYCLORAMA_VECTOR_CLONES
void trace_fisheye(const Setup& s, int count, const float* x, const float* y, const CameraRays& ret) {
  trace<Kind::kFisheye>(s, count, x, y, ret);
}
CYCLORAMA_VECTOR_CLONES
void trace_equirectangular(const Setup& s, int count, const float* x, const float* y, const CameraRays& ret) {
  trace<Kind::kEquirectangular>(s, count, x, y, ret);
}

/// Writes 1 to `exists` for each position inside the circle, else 0. Returns the number inside.
CYCLORAMA_VECTOR_CLONES
int mark_circle(const Setup& s, int count, const float* __restrict__ in_x, const float* __restrict__ in_y,
                std::uint8_t* __restrict__ exists) {
  int inside = 0;
  for (int i = 0; i < count; ++i) {
    const float x = in_x[i] - s.middle_x;
    const float y = (in_y[i] >= s.seam_y ? in_y[i] - s.seam_height : in_y[i]) - s.middle_y;
    const int in = x * x + y * y <= s.radius2_px ? 1 : 0;
    exists[i] = static_cast<std::uint8_t>(in);
    inside += in;
  }
  return inside;
}

/// Converts a range of angles or tangents over `pixels` pixels to the scale and offset of a Setup.
void spread(double from, double to, int pixels, float* ret_scale, float* ret_offset) {
  *ret_scale = static_cast<float>((to - from) / pixels);
  *ret_offset = static_cast<float>(0.5 * (from + to));
}

double set_up(const Panorama& p, Setup* ret) {
  ret->kind = Kind::kPanorama;
  const double half = 0.25 * p.azimuth_span_rad;
  spread(-half, half, p.width_px, &ret->scale_x, &ret->offset_x);
  spread(p.tan_elevation_top, p.tan_elevation_bottom, p.height_px, &ret->scale_y, &ret->offset_y);
  ret->cone_x = 2.0f * ret->scale_x;
  ret->cone_y = -ret->scale_y;
  return 0.0;
}

double set_up(const Perspective& p, Setup* ret) {
  ret->kind = Kind::kPerspective;
  spread(p.tan_left, p.tan_right, p.width_px, &ret->scale_x, &ret->offset_x);
  spread(p.tan_top, p.tan_bottom, p.height_px, &ret->scale_y, &ret->offset_y);
  ret->cone_x = ret->scale_x;
  ret->cone_y = -ret->scale_y;
  return p.tilt_rad;
}

double set_up(const Fisheye& p, Setup* ret) {
  ret->kind = Kind::kFisheye;
  ret->scale_x = static_cast<float>(0.5 * p.radians_per_px());
  ret->scale_y = -ret->scale_x;
  ret->cone_x = ret->cone_y = 2.0f * ret->scale_x;
  ret->radius2_px = static_cast<float>(p.radius_px() * p.radius_px());
  return p.tilt_rad;
}

double set_up(const Equirectangular& p, Setup* ret) {
  ret->kind = Kind::kEquirectangular;
  const double half = 0.25 * p.azimuth_span_rad;
  spread(-half, half, p.width_px, &ret->scale_x, &ret->offset_x);
  spread(0.5 * p.elevation_top_rad, 0.5 * p.elevation_bottom_rad, p.height_px, &ret->scale_y, &ret->offset_y);
  ret->cone_x = 2.0f * ret->scale_x;
  ret->cone_y = -2.0f * ret->scale_y;
  return 0.0;
}

}  // namespace

RayCamera::RayCamera() : RayCamera(Projection{Panorama{1, 1, 1.0, 0.5, -0.5}, {}}, 0.0) {}

RayCamera::RayCamera(const Projection& projection, double heading_rad) {
  CHECK(projection.validate().has_value());
  const double tilt = std::visit([&](const auto& shape) { return set_up(shape, &s_); }, projection.shape);
  const int height = height_px(projection.shape);
  s_.middle_x = 0.5f * static_cast<float>(projection.width_px());
  s_.middle_y = 0.5f * static_cast<float>(height);
  const Eigen::Matrix3d heading = Eigen::AngleAxisd(-heading_rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const Eigen::Matrix3d turn = heading * Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()).toRotationMatrix();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) s_.turn[3 * row + column] = static_cast<float>(turn(row, column));
  }

  const Viewing& viewing = projection.viewing;
  const bool both = viewing.eyes == Eyes::kOverUnder;
  const auto half = static_cast<float>(0.5 * viewing.eye_distance_m);
  s_.seam_y = static_cast<float>(both ? height : projection.height_px() + 1);
  s_.seam_height = static_cast<float>(height);
  s_.upper_side = viewing.eyes == Eyes::kMono ? 0.0f : viewing.eyes == Eyes::kRight ? half : -half;
  s_.lower_side = half;
  s_.moves = s_.upper_side != 0.0f || !viewing.viewer_m.isZero(0.0);
  s_.inverse_screen_m = static_cast<float>(1.0 / viewing.screen_distance_m);
  s_.pole_fade = std::max(static_cast<float>(std::sin(viewing.pole_fade_rad)), std::numeric_limits<float>::min());
  const Eigen::Vector3d viewer = heading * viewing.viewer_m;
  const Eigen::Vector3d right = heading.col(0);
  for (int i = 0; i < 3; ++i) {
    s_.viewer[i] = static_cast<float>(viewer[i]);
    s_.right[i] = static_cast<float>(right[i]);
  }
}

int RayCamera::rays(int count, const float* x, const float* y, const CameraRays& ret) const {
  switch (s_.kind) {
    case Kind::kPanorama:
      trace_panorama(s_, count, x, y, ret);
      break;
    case Kind::kPerspective:
      trace_perspective(s_, count, x, y, ret);
      break;
    case Kind::kEquirectangular:
      trace_equirectangular(s_, count, x, y, ret);
      break;
    case Kind::kFisheye:
      const int inside = mark_circle(s_, count, x, y, ret.exists);
      if (inside > 0) trace_fisheye(s_, count, x, y, ret);
      return inside;
  }
  std::fill_n(ret.exists, count, std::uint8_t{1});
  return count;
}

bool RayCamera::ray(float x, float y, CameraRay* ret) const {
  std::uint8_t exists = 0;
  rays(1, &x, &y,
       {&ret->origin.x(), &ret->origin.y(), &ret->origin.z(), &ret->direction.x(), &ret->direction.y(),
        &ret->direction.z(), &ret->cone, &exists});
  return exists != 0;
}

}  // namespace cyclorama::render

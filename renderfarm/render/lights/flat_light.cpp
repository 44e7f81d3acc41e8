// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/lights/flat_light.h"

#include <cmath>
#include <complex>

namespace cyclorama::render {
namespace {

/// Distance, in half diagonals, beyond which a rectangle is sampled by area. Apart from the cosine, the pdf then
/// differs by less than 1 % from one that is uniform in solid angle, and sampling takes a third of the time.
constexpr double kFarHalfDiagonals = 16.0;
/// Distance, in radii, beyond which a disk is sampled by area. It is smaller than for rectangles, because solid-angle
/// sampling of the bounding square misses the disk with 1 - pi/4 of its samples.
constexpr double kFarRadii = 4.0;

/// The light's rectangle (for a disk, its bounding square) as seen from p: its corners (x, y) in its own plane, at
/// distance z > 0. Uses double, because the solid angle is a difference of larger angles.
struct View {
  double x0 = 0.0;
  double x1 = 0.0;
  double y0 = 0.0;
  double y1 = 0.0;
  double z = 0.0;  ///< Zero or negative if seen from behind.
  bool far = false;
};

View view_of(const FlatLight& light, const Vec3& p) {
  const Eigen::Vector3d offset = light.centre.cast<double>() - p.cast<double>();
  const double x = offset.dot(light.across.cast<double>());
  const double y = offset.dot(light.up.cast<double>());
  const double z = -offset.dot(light.normal.cast<double>());
  const double hx = static_cast<double>(light.half.x());
  const double hy = static_cast<double>(light.half.y());
  const double size2 =
      light.is_disk ? kFarRadii * kFarRadii * hx * hx : kFarHalfDiagonals * kFarHalfDiagonals * (hx * hx + hy * hy);
  return {x - hx, x + hx, y - hy, y + hy, z, x * x + y * y + z * z > size2};
}

/// The solid angle of a View, with the angle k that sampling needs.
///
/// The inner angles of the spherical rectangle are the arguments of four complex numbers, computed from the normals of
/// the planes through p and an edge (Ureña et al., equation 4 with the square roots multiplied out, so that nothing
/// cancels). Their sum minus 2 pi is the solid angle. It is computed from the product of the numbers, with one
/// arctangent instead of four arccosines.
struct SolidAngle {
  double value = 0.0;
  double cos_k = 1.0;  ///< Cosine of the paper's k.
  double sin_k = 0.0;
};

using Complex = std::complex<double>;

Complex product(const Complex& a, const Complex& b) {  // Faster than std::complex's operator, which handles infinities.
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

SolidAngle solid_angle_of(const View& v) {
  const double z2 = v.z * v.z;
  const double xx0 = v.x0 * v.x0 + z2;
  const double xx1 = v.x1 * v.x1 + z2;
  const double yy0 = v.y0 * v.y0;
  const double yy1 = v.y1 * v.y1;
  const Complex first = product({v.x1 * v.y0, v.z * std::sqrt(xx1 + yy0)}, {-v.x1 * v.y1, v.z * std::sqrt(xx1 + yy1)});
  const Complex second = product({v.x0 * v.y1, v.z * std::sqrt(xx0 + yy1)}, {-v.x0 * v.y0, v.z * std::sqrt(xx0 + yy0)});
  const Complex all = product(first, second);
  SolidAngle angle;
  angle.value = std::atan2(all.imag(), all.real());
  if (angle.value < 0.0) angle.value += 2.0 * static_cast<double>(kPi);
  const double length = std::sqrt(second.real() * second.real() + second.imag() * second.imag());
  if (!(length > 0.0) || !std::isfinite(angle.value)) return {};
  angle.cos_k = second.real() / length;
  angle.sin_k = -second.imag() / length;
  return angle;
}

struct Place {
  double x = 0.0;
  double y = 0.0;
};

/// Returns a position sampled by solid angle. Source: Ureña et al., section 4.
Place place_by_solid_angle(const View& v, const SolidAngle& angle, const Vec2& u) {
  const double turn = static_cast<double>(u.x()) * angle.value;
  const double cos_turn = std::cos(turn);
  const double sin_turn = std::sin(turn);
  const double cos_au = cos_turn * angle.cos_k - sin_turn * angle.sin_k;
  const double sin_au = sin_turn * angle.cos_k + cos_turn * angle.sin_k;
  const double z2 = v.z * v.z;
  const double h0 = 1.0 / (z2 + v.y0 * v.y0);
  const double b0 = -v.y0 * std::sqrt(h0);
  const double b1 = v.y1 / std::sqrt(z2 + v.y1 * v.y1);
  const double top = cos_au * b0 - b1;
  const double under = std::sqrt(std::max(0.0, top * top - sin_au * sin_au * z2 * h0));
  const double side = top < 0.0 ? -sin_au : sin_au;
  double x = under > 0.0 ? side * v.z / under : (side < 0.0 ? v.x0 : v.x1);
  x = std::clamp(x, v.x0, v.x1);

  const double d2 = x * x + z2;
  const double low = v.y0 / std::sqrt(d2 + v.y0 * v.y0);
  const double high = v.y1 / std::sqrt(d2 + v.y1 * v.y1);
  const double h = low + static_cast<double>(u.y()) * (high - low);
  const double rest = 1.0 - h * h;
  const double y = rest > 0.0 ? h * std::sqrt(d2 / rest) : v.y1;
  return {x, std::clamp(y, v.y0, v.y1)};
}

/// Maps the unit square to the unit disk by Shirley and Chiu's concentric map, which keeps neighbours together.
Vec2 on_unit_disk(const Vec2& u) {
  const Vec2 s = 2.0f * u - Vec2::Ones();
  if (s.isZero(0.0f)) return Vec2::Zero();
  const bool flat = std::abs(s.x()) > std::abs(s.y());
  const float radius = flat ? s.x() : s.y();
  const float angle = flat ? 0.25f * kPi * (s.y() / s.x()) : 0.5f * kPi - 0.25f * kPi * (s.x() / s.y());
  return radius * Vec2(std::cos(angle), std::sin(angle));
}

Place place_by_area(const FlatLight& light, const View& v, const Vec2& u) {
  const Vec2 at = light.is_disk ? on_unit_disk(u) : Vec2(2.0f * u - Vec2::Ones());
  return {0.5 * (v.x0 + v.x1) + static_cast<double>(at.x() * light.half.x()),
          0.5 * (v.y0 + v.y1) + static_cast<double>(at.y() * light.half.y())};
}

}  // namespace

FlatLight make_flat_light(const scene::Light& light, const Eigen::Vector3d& origin) {
  FlatLight flat;
  flat.is_disk = light.kind == scene::LightKind::kDisk;
  flat.visible = light.visible;
  flat.group = light.group;
  flat.centre = (light.position - origin).cast<float>();
  flat.normal = normalized_or(light.direction.cast<float>(), Vec3(0.0f, -1.0f, 0.0f));
  const Vec3 across = light.across.cast<float>();
  flat.across =
      normalized_or(across - flat.normal * flat.normal.dot(across), from_frame_of(flat.normal, Vec3::UnitX()));
  flat.up = flat.normal.cross(flat.across);
  const double radius = light.radius_m;
  const Eigen::Vector2d half = flat.is_disk ? Eigen::Vector2d(radius, radius) : Eigen::Vector2d(0.5 * light.size_m);
  flat.half = half.cast<float>().cwiseMax(0.0f);
  flat.radiance = light.intensity.cwiseMax(0.0f);
  return flat;
}

bool is_lit(const FlatLight& light) {
  return std::isnormal(light.area()) && std::isnormal(luminance(light.radiance) * light.area()) &&
         is_finite(light.radiance) && is_finite(light.centre);
}

bool sample_flat(const FlatLight& light, const Vec3& p, const Vec2& u, LightSample* ret_sample) {
  const View view = view_of(light, p);
  if (!(view.z > 0.0)) return false;
  Place at;
  double solid_angle = 0.0;  // Inverse of the pdf.
  if (!view.far) {
    const SolidAngle angle = solid_angle_of(view);
    solid_angle = angle.value;
    at = place_by_solid_angle(view, angle, u);
  } else {
    at = place_by_area(light, view, u);
  }
  if (light.is_disk && !view.far) {
    const double x = at.x - 0.5 * (view.x0 + view.x1);
    const double y = at.y - 0.5 * (view.y0 + view.y1);
    const auto radius = static_cast<double>(light.half.x());
    if (!(x * x + y * y <= radius * radius)) return false;
  }
  const double distance2 = at.x * at.x + at.y * at.y + view.z * view.z;
  const double distance = std::sqrt(distance2);
  const double cosine = view.z / distance;
  if (view.far) solid_angle = static_cast<double>(light.area()) * cosine / distance2;
  if (!(solid_angle > 0.0)) return false;
  const Eigen::Vector3d way =
      at.x * light.across.cast<double>() + at.y * light.up.cast<double>() - view.z * light.normal.cast<double>();
  ret_sample->direction = (way / distance).cast<float>();
  ret_sample->distance = short_of(p, static_cast<float>(distance), static_cast<float>(cosine));
  ret_sample->radiance_over_pdf = light.radiance * static_cast<float>(solid_angle);
  ret_sample->pdf = light.visible ? static_cast<float>(1.0 / solid_angle) : 0.0f;
  return true;
}

float flat_pdf(const FlatLight& light, const Vec3& p, const Vec3& direction, float distance) {
  if (!light.visible) return 0.0f;
  const View view = view_of(light, p);
  const float cosine = -light.normal.dot(direction);
  if (!(view.z > 0.0) || !(cosine > 0.0f)) return 0.0f;
  if (view.far) return distance * distance / (cosine * light.area());
  const double angle = solid_angle_of(view).value;
  return angle > 0.0 ? static_cast<float>(1.0 / angle) : 0.0f;
}

}  // namespace cyclorama::render

// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/generator/statue_head.h"

#include "renderfarm/generator/noise.h"
#include "renderfarm/generator/paint.h"
#include "renderfarm/generator/solid.h"

namespace cyclorama::generator {
namespace {

/// Returns the height of the brow at `x` from the middle.
float brow_height(float x, float sorrow) {
  const float t = unit_clamp((x - 0.07f) / 0.53f);
  return 0.13f + 0.15f * std::sin(kPi * std::pow(t, 0.8f)) - 0.07f * t + sorrow * 0.10f * (0.5f - t);
}

/// Returns a number, roughly a length, that is positive where hair grows.
float hair_depth(const Vec3& p) {
  const float line = mix(-0.62f, 0.56f, smooth_step(-0.15f, 0.50f, p.z()));
  return std::min(p.y() - line, 0.62f);
}

float skull(const Vec3& p, const StatueHeadStyle& style) {
  float d = ellipsoid(p, {0.0f, 0.24f, -0.14f}, {0.80f, 0.84f, 0.92f});
  d = blend(d, ellipsoid(p, {0.0f, -0.26f, 0.12f}, {0.66f, 0.74f, 0.70f}), 0.25f);
  const Vec3 m{std::abs(p.x()), p.y(), p.z()};
  d = blend(d, sphere(m, {0.34f, -0.26f, 0.44f}, 0.30f - 0.07f * style.age), 0.3f);  // Cheek.
  d = blend(d, sphere(p, {0.0f, -0.84f, 0.52f}, 0.20f), 0.22f);                      // Chin.
  return blend(d, limb(p, {0.0f, -0.55f, -0.12f}, 0.44f, {0.0f, -1.6f, -0.20f}, 0.50f), 0.16f);
}

float features(const Vec3& p, float d, const StatueHeadStyle& style) {
  const Vec3 m{std::abs(p.x()), p.y(), p.z()};
  // Sockets, then the bulge of the lids in them.
  d = carve(d, ellipsoid(m, {0.30f, 0.03f, 0.97f}, {0.24f, 0.10f, 0.17f}), 0.18f);
  d = blend(d, ellipsoid(m, {0.29f, -0.01f, 0.655f}, {0.21f, 0.105f, 0.16f}), 0.04f);
  // Brow ridge, along the arc.
  const Vec3 inner{0.10f, brow_height(0.10f, style.sorrow), 0.83f};
  const Vec3 top{0.32f, brow_height(0.32f, style.sorrow) + 0.01f, 0.775f};
  const Vec3 outer{0.60f, brow_height(0.60f, style.sorrow), 0.53f};
  d = blend(d, std::min(limb(m, inner, 0.02f, top, 0.02f), limb(m, top, 0.02f, outer, 0.01f)), 0.15f);
  // Nose: straight from the brow.
  d = blend(d, limb(p, {0.0f, 0.16f, 0.80f}, 0.050f, {0.0f, -0.27f, 0.985f}, 0.080f), 0.10f);
  d = blend(d, ellipsoid(m, {0.090f, -0.305f, 0.86f}, {0.075f, 0.060f, 0.095f}), 0.06f);
  // Small full lips, corners tucked in.
  const float droop = 0.05f * style.sorrow;
  const float upper = limb(m, {0.0f, -0.505f, 0.840f}, 0.034f, {0.165f, -0.525f - droop, 0.785f}, 0.014f);
  const float lower = limb(m, {0.0f, -0.590f, 0.825f}, 0.050f, {0.120f, -0.570f - droop, 0.785f}, 0.024f);
  return blend(d, blend(upper, lower, 0.04f), 0.10f);
}

float ears(const Vec3& p, float d, bool long_lobes) {
  const Vec3 m{std::abs(p.x()), p.y(), p.z()};
  float ear = ellipsoid(m, {0.755f, 0.02f, -0.10f}, {0.075f, 0.26f, 0.15f});
  ear = carve(ear, ellipsoid(m, {0.85f, 0.04f, -0.05f}, {0.07f, 0.17f, 0.07f}), 0.05f);
  const Vec3 lobe_end{0.70f, long_lobes ? -0.58f : -0.24f, 0.02f};
  ear = blend(ear, limb(m, {0.755f, -0.18f, -0.04f}, 0.055f, lobe_end, 0.065f), 0.08f);
  return blend(d, ear, 0.08f);
}

float curls(const Vec3& p) {
  const float elevation = std::atan2(p.y() - 0.1f, std::hypot(p.x(), p.z() + 0.1f));
  constexpr float kStep = 0.125f;
  const auto [row, dy] = repeat(elevation, kStep);
  const float girth =
      std::max(3.0f, std::round(2.0f * kPi * std::cos((static_cast<float>(row) + 0.5f) * kStep) / kStep));
  const float turn = std::atan2(p.x(), p.z() + 0.1f) / (2.0f * kPi) * girth + (cycle(row, 2) == 0 ? 0.0f : 0.5f);
  const float dx = repeat(turn, 1.0f).offset * kStep;
  return std::max(0.0f, 1.0f - std::hypot(dx, dy) / (0.52f * kStep));
}

bool on_ear(const Vec3& p) { return std::abs(p.x()) > 0.73f && p.y() < 0.30f && p.z() > -0.26f; }

float relief_of(const Vec3& p, const StatueHeadStyle& style) {
  float relief = 0.0f;
  if (style.buddha) {
    const float hair = on_ear(p) ? 0.0f : smooth_step(0.0f, 0.04f, hair_depth(p));
    if (hair > 0.0f) relief += hair * (0.035f + 0.05f * std::sqrt(curls(p)));
  }
  // Three rings on the neck.
  for (const float ring : {-1.10f, -1.25f, -1.40f}) {
    const float q = (p.y() - ring) / 0.03f;
    relief -= 0.022f * std::exp(-q * q) * smooth_step(-1.0f, -1.05f, p.y());
  }
  return relief;
}

/// Paints a half-closed eye that looks down: both edges of the opening sag, the lower edge more.
void lay_eye(const Vec2& p, float spacing, Spot& spot) {
  const float q = (p.x() - 0.295f) / 0.205f;
  const float arch = std::max(0.0f, 1.0f - q * q);
  const float slant = -0.040f + 0.014f * q;
  const float upper = slant - 0.010f * arch;
  const float lower = slant - 0.050f * arch;
  const float open = std::max(p.y() - upper, lower - p.y());
  spot.lay(pigment::kWhite, coverage(std::max(open, (std::abs(q) - 0.97f) * 0.2f), spacing));
  spot.lay(pigment::kInk, coverage(std::max(open, (p - Vec2(0.285f, -0.060f)).norm() - 0.050f), spacing));
  const float lid_end = smooth_step(1.12f, 0.98f, std::abs(q));
  spot.lay(pigment::kInk, line_coverage(p.y() - upper, 0.018f, spacing) * lid_end);
  spot.lay(pigment::kRust, 0.5f * line_coverage(p.y() - upper - 0.085f * std::sqrt(arch), 0.012f, spacing) * lid_end);
}

void lay_face(const Vec3& p, const StatueHeadStyle& style, float spacing, Spot& spot) {
  using namespace pigment;  // NOLINT(google-build-using-namespace)
  const float x = std::abs(p.x());
  const Vec2 m{x, p.y()};
  // Warmth on the cheeks, shade in the sockets and below the lip.
  spot.lay(kCinnabar, 0.13f * std::exp(-(m - Vec2(0.40f, -0.30f)).squaredNorm() / 0.05f));
  spot.darken(0.16f * std::exp(-(m - Vec2(0.25f, 0.10f)).squaredNorm() / 0.012f));
  spot.darken(0.18f * std::exp(-(m - Vec2(0.0f, -0.68f)).squaredNorm() / 0.006f));
  lay_eye(m, spacing, spot);
  const float brow = (p.y() - 0.035f) - brow_height(x, style.sorrow);
  spot.lay(kInk,
           0.9f * line_coverage(brow, mix(0.036f, 0.016f, x / 0.6f), spacing) * smooth_window(0.07f, 0.60f, 0.03f, x));
  const float droop = 0.05f * style.sorrow * x / 0.2f;
  const float bow = 0.014f * std::cos(std::min(x, 0.2f) * 30.0f);
  const float lips = ellipse({x, p.y() + droop + (p.y() > -0.54f ? bow : 0.0f)}, {0.0f, -0.545f}, {0.180f, 0.075f});
  spot.lay(mix(kCinnabar, style.skin, 0.30f), coverage(lips, spacing));
  const float parting = p.y() + 0.540f + droop + 0.012f * std::cos(x * 18.0f) - 0.25f * x * x;
  spot.lay(kInk, 0.45f * line_coverage(parting, 0.014f, spacing) * coverage(x - 0.19f, spacing));
  if (style.buddha) spot.lay(kWhite, coverage((m - Vec2(0.0f, 0.34f)).norm() - 0.038f, spacing));
}

Vec3 colour_of(const Vec3& p, const StatueHeadStyle& style, float spacing) {
  Spot spot(style.skin);
  spot.darken(0.10f * unit_clamp(fractal_noise(p * 4.0f, 3, 31u) + 0.2f));
  // Shade under the chin, in the rings of the neck and behind the ears.
  spot.darken(0.45f * smooth_step(-0.72f, -1.0f, p.y()) * smooth_step(0.55f, 0.30f, p.z()));
  if (p.z() > 0.35f && p.y() < 0.55f) lay_face(p, style, spacing, spot);
  const bool ear = on_ear(p);
  const float depth = hair_depth(p);
  if (!ear && style.buddha) {
    const float curl = curls(p);
    spot.lay(mix(pigment::kIndigo, pigment::kPaleBlue, 0.35f * curl) * mix(0.55f, 1.0f, curl),
             coverage(-depth, std::max(spacing, 0.03f)));
  } else if (!ear) {
    spot.lay(mix(style.skin, pigment::kPaleBlue * 0.7f, 0.5f), smooth_step(0.0f, 0.2f, depth) * 0.8f);
  }
  return spot.colour();
}

}  // namespace

Sculpture statue_head(const StatueHeadStyle& style) {
  Sculpture s;
  s.distance = [style](const Vec3& p) {
    float d = skull(p, style);
    if (style.buddha) d = blend(d, ellipsoid(p, {0.0f, 1.06f, -0.18f}, {0.42f, 0.36f, 0.42f}), 0.14f);
    if (p.z() > 0.3f) d = features(p, d, style);
    return ears(p, d, style.buddha);
  };
  s.relief = [style](const Vec3& p, float) { return relief_of(p, style); };
  s.colour = [style](const Vec3& p, float spacing) { return colour_of(p, style, spacing); };
  s.from = {0.0f, -1.15f, -0.15f};
  s.to = {0.0f, 0.35f, -0.08f};
  s.reach = 1.6f;
  s.front_focus = 0.50f;
  s.ends = 0.75f;
  s.girth = 3.0f;  // Less than the circumference, so that more rows remain for lids and lips, which run along rows.
  return s;
}

}  // namespace cyclorama::generator

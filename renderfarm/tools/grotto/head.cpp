// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/tools/grotto/head.h"

#include "renderfarm/tools/grotto/noise.h"
#include "renderfarm/tools/grotto/paint.h"
#include "renderfarm/tools/grotto/solid.h"

namespace cyclorama::grotto {
namespace {

/// Height of the brow's line at `x` from the middle.
float brow_height(float x, float sorrow) {
  const float t = unit_clamp((x - 0.07f) / 0.53f);
  return 0.13f + 0.15f * std::sin(kPi * std::pow(t, 0.8f)) - 0.07f * t + sorrow * 0.10f * (0.5f - t);
}

/// Positive where hair grows, in units of length about.
float hair_depth(const Vec3& p) {
  const float line = mix(-0.62f, 0.56f, smooth_step(-0.15f, 0.50f, p.z()));
  return std::min(p.y() - line, 0.62f);
}

float skull(const Vec3& p, const HeadStyle& style) {
  float d = ellipsoid(p, {0.0f, 0.24f, -0.14f}, {0.80f, 0.84f, 0.92f});
  d = blend(d, ellipsoid(p, {0.0f, -0.26f, 0.12f}, {0.66f, 0.74f, 0.70f}), 0.25f);
  const Vec3 m{std::abs(p.x()), p.y(), p.z()};
  d = blend(d, sphere(m, {0.34f, -0.26f, 0.44f}, 0.30f - 0.07f * style.age), 0.3f);  // Cheek.
  d = blend(d, sphere(p, {0.0f, -0.84f, 0.52f}, 0.20f), 0.22f);                      // Chin.
  return blend(d, limb(p, {0.0f, -0.55f, -0.12f}, 0.44f, {0.0f, -1.6f, -0.20f}, 0.50f), 0.16f);
}

float features(const Vec3& p, float d, const HeadStyle& style) {
  const Vec3 m{std::abs(p.x()), p.y(), p.z()};
  // Sockets, then the lids' swell in them.
  d = carve(d, ellipsoid(m, {0.30f, 0.02f, 0.95f}, {0.23f, 0.10f, 0.17f}), 0.16f);
  d = blend(d, ellipsoid(m, {0.29f, -0.015f, 0.66f}, {0.20f, 0.105f, 0.155f}), 0.03f);
  const float lid = limb(m, {0.13f, -0.055f, 0.83f}, 0.012f, {0.47f, -0.045f, 0.70f}, 0.010f);
  d = carve(d, lid, 0.02f);
  // Brow ridge: three short limbs along the arc.
  const Vec3 inner{0.09f, brow_height(0.09f, style.sorrow), 0.86f};
  const Vec3 top{0.30f, brow_height(0.30f, style.sorrow) + 0.01f, 0.80f};
  const Vec3 outer{0.60f, brow_height(0.60f, style.sorrow), 0.54f};
  d = blend(d, std::min(limb(m, inner, 0.035f, top, 0.035f), limb(m, top, 0.035f, outer, 0.02f)), 0.09f);
  // Nose.
  d = blend(d, limb(p, {0.0f, 0.14f, 0.82f}, 0.055f, {0.0f, -0.27f, 0.985f}, 0.095f), 0.09f);
  d = blend(d, ellipsoid(m, {0.105f, -0.31f, 0.86f}, {0.085f, 0.07f, 0.10f}), 0.06f);
  // Lips with a bow, corners tucked in.
  const float droop = 0.05f * style.sorrow;
  const float upper = limb(m, {0.05f, -0.495f, 0.865f}, 0.045f, {0.21f, -0.525f - droop, 0.755f}, 0.02f);
  const float lower = limb(m, {0.0f, -0.60f, 0.845f}, 0.060f, {0.15f, -0.575f - droop, 0.775f}, 0.025f);
  d = blend(d, std::min(upper, lower), 0.045f);
  return carve(d, sphere(m, {0.255f, -0.535f - droop, 0.80f}, 0.03f), 0.06f);
}

float ears(const Vec3& p, float d, bool long_lobes) {
  const Vec3 m{std::abs(p.x()), p.y(), p.z()};
  float ear = ellipsoid(m, {0.82f, 0.02f, -0.10f}, {0.085f, 0.30f, 0.18f});
  ear = carve(ear, ellipsoid(m, {0.92f, 0.04f, -0.06f}, {0.07f, 0.20f, 0.09f}), 0.05f);
  const Vec3 lobe_end{0.76f, long_lobes ? -0.82f : -0.30f, 0.02f};
  ear = blend(ear, limb(m, {0.82f, -0.20f, -0.04f}, 0.075f, lobe_end, 0.085f), 0.08f);
  return blend(d, ear, 0.05f);
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

float relief_of(const Vec3& p, const HeadStyle& style) {
  float relief = 0.0f;
  if (style.buddha) {
    const float hair = smooth_step(0.0f, 0.04f, hair_depth(p));
    if (hair > 0.0f) relief += hair * (0.035f + 0.05f * std::sqrt(curls(p)));
  }
  // Three rings on the neck.
  for (const float ring : {-1.10f, -1.25f, -1.40f}) {
    const float q = (p.y() - ring) / 0.03f;
    relief -= 0.022f * std::exp(-q * q) * smooth_step(-1.0f, -1.05f, p.y());
  }
  return relief;
}

void lay_eye(const Vec2& p, float spacing, Spot& spot) {
  const float q = (p.x() - 0.30f) / 0.20f;
  const float arch = std::max(0.0f, 1.0f - q * q);
  const float slant = 0.015f * q;
  const float upper = -0.025f + 0.030f * arch + slant;
  const float lower = -0.050f - 0.022f * arch + slant;
  const float open = std::max(p.y() - upper, lower - p.y());
  spot.lay(pigment::kWhite, coverage(std::max(open, std::abs(q) * 0.2f - 0.19f), spacing));
  spot.lay(pigment::kInk, coverage(std::max(open, std::abs(p.x() - 0.29f) - 0.055f), spacing));
  spot.lay(pigment::kInk, line_coverage(p.y() - upper, 0.022f, spacing) * smooth_step(1.15f, 0.95f, std::abs(q)));
}

void lay_face(const Vec3& p, const HeadStyle& style, float spacing, Spot& spot) {
  using namespace pigment;  // NOLINT(google-build-using-namespace)
  const float x = std::abs(p.x());
  const Vec2 m{x, p.y()};
  // Warmth on the cheeks, shade in the sockets and below the lip.
  spot.lay(kCinnabar, 0.16f * std::exp(-(m - Vec2(0.40f, -0.30f)).squaredNorm() / 0.05f));
  spot.darken(0.20f * std::exp(-(m - Vec2(0.27f, 0.09f)).squaredNorm() / 0.012f));
  spot.darken(0.22f * std::exp(-(m - Vec2(0.0f, -0.69f)).squaredNorm() / 0.006f));
  lay_eye(m, spacing, spot);
  const float brow = (p.y() - 0.035f) - brow_height(x, style.sorrow);
  spot.lay(kInk, line_coverage(brow, mix(0.045f, 0.02f, x / 0.6f), spacing) * smooth_window(0.07f, 0.60f, 0.03f, x));
  const float droop = 0.05f * style.sorrow * x / 0.2f;
  const float lips = ellipse({x, p.y() + droop}, {0.0f, -0.545f}, {0.215f, 0.085f});
  spot.lay(mix(kCinnabar, style.skin, 0.25f), coverage(lips, spacing));
  spot.lay(kInk, line_coverage(p.y() + 0.542f + droop - 0.02f * std::cos(x * 14.0f), 0.018f, spacing) *
                     coverage(x - 0.21f, spacing) * 0.8f);
  if (style.buddha) spot.lay(kWhite, coverage((m - Vec2(0.0f, 0.34f)).norm() - 0.045f, spacing));
}

Vec3 colour_of(const Vec3& p, const HeadStyle& style, float spacing) {
  Spot spot(style.skin);
  spot.darken(0.10f * unit_clamp(fractal_noise(p * 4.0f, 3, 31u) + 0.2f));
  // Shade under the chin, in the rings of the neck and behind the ears.
  spot.darken(0.45f * smooth_step(-0.72f, -1.0f, p.y()) * smooth_step(0.55f, 0.30f, p.z()));
  if (p.z() > 0.35f && p.y() < 0.55f) lay_face(p, style, spacing, spot);
  const bool ear = std::abs(p.x()) > 0.76f && p.y() < 0.32f && p.z() > -0.30f;
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

Sculpture head(const HeadStyle& style) {
  Sculpture s;
  s.distance = [style](const Vec3& p) {
    float d = skull(p, style);
    if (style.buddha) d = blend(d, ellipsoid(p, {0.0f, 1.06f, -0.18f}, {0.42f, 0.36f, 0.42f}), 0.14f);
    if (p.z() > 0.3f) d = features(p, d, style);
    return ears(p, d, style.buddha);
  };
  s.relief = [style](const Vec3& p) { return relief_of(p, style); };
  s.colour = [style](const Vec3& p, float spacing) { return colour_of(p, style, spacing); };
  s.from = {0.0f, -1.15f, -0.15f};
  s.to = {0.0f, 0.35f, -0.08f};
  s.reach = 1.6f;
  s.front_focus = 0.55f;
  s.girth = 4.6f;
  return s;
}

}  // namespace cyclorama::grotto

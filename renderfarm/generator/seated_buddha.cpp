// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "renderfarm/generator/figures.h"
#include "renderfarm/generator/noise.h"
#include "renderfarm/generator/paint.h"
#include "renderfarm/generator/solid.h"
#include "renderfarm/generator/statue_head.h"

namespace cyclorama::generator {
namespace {

using namespace pigment;  // NOLINT(google-build-using-namespace): colours by name, in this file only.

struct Robes {
  Vec3 outer;
  Vec3 inner;
  Vec3 skin;
};

const Robes& robes_of(std::uint32_t variety) {
  static const std::array<Robes, 5> all = {{{kCinnabar, kMalachite, kFlesh},
                                            {kRust, kAzurite, kFlesh},
                                            {kMalachite, kOchre, kFlesh},
                                            {kOchre, kCinnabar, kGold},
                                            {kAzurite, kCinnabar, kFlesh}}};
  return all[variety % all.size()];
}

float hands(const Vec3& p) {
  const Vec3 m{std::abs(p.x()), p.y(), p.z()};
  return blend(ellipsoid(p, {0.0f, 0.205f, 0.235f}, {0.105f, 0.028f, 0.062f}),
               limb(m, {0.11f, 0.205f, 0.19f}, 0.032f, {0.03f, 0.225f, 0.265f}, 0.018f), 0.02f);
}

float body(const Vec3& p) {
  const Vec3 m{std::abs(p.x()), p.y(), p.z()};
  float d = ellipsoid(p, {0.0f, 0.13f, 0.0f}, {0.25f, 0.14f, 0.21f});
  d = blend(d, ellipsoid(p, {0.0f, 0.31f, 0.01f}, {0.155f, 0.17f, 0.12f}), 0.08f);
  d = blend(d, ellipsoid(p, {0.0f, 0.475f, 0.0f}, {0.19f, 0.155f, 0.125f}), 0.08f);
  d = blend(d, limb(m, {0.0f, 0.585f, -0.01f}, 0.075f, {0.195f, 0.555f, -0.015f}, 0.068f), 0.06f);
  // Thigh, and the shin crossed before it.
  d = blend(d, limb(m, {0.12f, 0.10f, 0.02f}, 0.105f, {0.40f, 0.085f, 0.12f}, 0.085f), 0.05f);
  d = blend(d, limb(m, {0.40f, 0.075f, 0.14f}, 0.078f, {0.06f, 0.075f, 0.265f}, 0.062f), 0.04f);
  // Arms, with sleeves that hang from them.
  d = blend(d, limb(m, {0.225f, 0.545f, -0.01f}, 0.070f, {0.285f, 0.30f, 0.01f}, 0.060f), 0.04f);
  d = blend(d, limb(m, {0.285f, 0.29f, 0.02f}, 0.062f, {0.10f, 0.205f, 0.20f}, 0.045f), 0.04f);
  return blend(d, hands(p), 0.015f);
}

/// Returns the distance to the opening of the robe at the breast: negative on skin, about 0 at the hem.
float opening(const Vec3& p) {
  if (p.z() < 0.02f || p.y() < 0.33f) return 1.0f;
  return ellipse({p.x() + 0.018f, p.y()}, {0.0f, 0.60f}, {0.105f, 0.20f});
}

constexpr float kFold = 0.052f;

/// Returns the phase of the folds: rings from the shoulders over the trunk, and rings around the knees over the legs.
float fold_phase(const Vec3& p) {
  const float trunk = std::hypot(p.x() * 0.75f + 0.04f, p.y() - 0.74f) / kFold;
  const float legs = std::hypot(std::abs(p.x()) - 0.05f, (p.y() - 0.30f) * 1.2f) / kFold;
  return mix(legs, trunk, smooth_step(0.17f, 0.24f, p.y()));
}

float fold(const Vec3& p) { return fold_profile(fold_phase(p)); }

float bare(const Vec3& p) { return std::min(opening(p), hands(p) - 0.008f); }

Sculpture trunk(const Robes& robes) {
  Sculpture s;
  s.distance = body;
  s.relief = [](const Vec3& p, float spacing) {
    return (0.013f * fold(p) - 0.005f) * smooth_step(0.0f, 0.02f, bare(p)) * shown(kFold, spacing);
  };
  s.colour = [robes](const Vec3& p, float spacing) {
    const float skin = bare(p);
    Spot spot(robes.outer);
    spot.lay(robes.inner, coverage(std::abs(opening(p) - 0.018f) - 0.018f, spacing));
    spot.lay(kGold, line_coverage(opening(p) - 0.040f, 0.008f, spacing));
    spot.lay(robes.inner, coverage(0.038f - p.y(), spacing));
    spot.darken(0.42f * (1.0f - fold(p)) * smooth_step(0.0f, 0.02f, skin) * shown(kFold, spacing));
    spot.lay(robes.skin, coverage(skin, spacing));
    spot.darken(0.35f * smooth_step(0.12f, 0.0f, p.y()));
    spot.lay(kPlaster, 0.30f * unit_clamp(fractal_noise(p * 9.0f, 3, 41u) + 0.1f));
    return spot.colour();
  };
  s.from = {0.0f, 0.10f, 0.05f};
  s.to = {0.0f, 0.50f, 0.0f};
  s.reach = 0.62f;
  s.front_focus = 0.35f;
  s.girth = 1.9f;
  return s;
}

/// Returns the throne: a waist with two rows of petals.
Sculpture throne(std::uint32_t variety) {
  Sculpture s;
  constexpr int kPetals = 16;
  const auto petal = [](const Vec3& p, float shift) {
    return std::abs(std::cos(0.5f * (std::atan2(p.x(), p.z()) + shift) * static_cast<float>(kPetals)));
  };
  s.distance = [](const Vec3& p) {
    float d = ellipsoid(p, {0.0f, -0.05f, 0.06f}, {0.53f, 0.075f, 0.44f});
    d = blend(d, ellipsoid(p, {0.0f, -0.125f, 0.06f}, {0.40f, 0.10f, 0.34f}), 0.03f);
    return blend(d, ellipsoid(p, {0.0f, -0.20f, 0.06f}, {0.50f, 0.045f, 0.42f}), 0.03f);
  };
  s.relief = [petal](const Vec3& p, float) {
    return 0.022f * std::sqrt(petal(p, p.y() > -0.12f ? 0.0f : kPi / kPetals));
  };
  s.colour = [petal, variety](const Vec3& p, float spacing) {
    const float edge = petal(p, p.y() > -0.12f ? 0.0f : kPi / kPetals);
    Spot spot(variety % 2u == 0u ? kMalachite : kCinnabar);
    spot.lay(kWhite, coverage((edge - 0.45f) * 0.05f, spacing));
    spot.lay(kGold, 0.5f * coverage(-p.y(), spacing));  // The seat's upper side.
    spot.darken(0.4f * (1.0f - std::sqrt(edge)));
    return spot.colour();
  };
  s.from = {0.0f, -0.20f, 0.06f};
  s.to = {0.0f, -0.05f, 0.06f};
  s.reach = 0.62f;
  s.girth = 3.0f;
  return s;
}

}  // namespace

std::vector<Patch> seated_buddha(const Pose& pose, std::uint32_t variety, float density) {
  const Robes& robes = robes_of(variety);
  Pose head_pose = pose;
  head_pose.position = pose.to_room({0.0f, 0.785f, 0.018f});
  head_pose.scale = 0.125f * pose.scale;
  head_pose.rotation = pose.rotation * Eigen::AngleAxisf(0.12f, Vec3::UnitX()).toRotationMatrix();
  Pose halo = pose;
  halo.position = pose.to_room({0.0f, 0.80f, -0.17f});
  Pose mandorla = pose;
  mandorla.position = pose.to_room({0.0f, 0.42f, -0.19f});
  return {wrapped(trunk(robes), pose, density), wrapped(statue_head({.skin = robes.skin}), head_pose, 1.5f * density),
          wrapped(throne(variety), pose, 0.8f * density),
          nimbus_disc(mandorla, {0.56f, 0.62f}, static_cast<int>(variety), 0.9f * density),
          nimbus_disc(halo, {0.29f, 0.29f}, static_cast<int>(variety) + 1, 0.9f * density)};
}

}  // namespace cyclorama::generator

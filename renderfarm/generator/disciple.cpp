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
  static const std::array<Robes, 6> all = {{{kRust, kMalachite, {0.76f, 0.56f, 0.40f}},
                                            {kMalachite, kCinnabar, {0.83f, 0.66f, 0.50f}},
                                            {kCinnabar, kPaleBlue, {0.70f, 0.50f, 0.36f}},
                                            {kOchre, kRust, {0.80f, 0.62f, 0.46f}},
                                            {kAzurite, kOchre, {0.74f, 0.55f, 0.40f}},
                                            {{0.36f, 0.30f, 0.26f}, kCinnabar, {0.66f, 0.46f, 0.32f}}}};
  return all[variety % all.size()];
}

/// Returns the distance to the hands: in prayer the palms meet before the breast; in grief one hand touches the cheek.
float hands(const Vec3& p, bool grief) {
  if (!grief) return ellipsoid(p, {0.0f, 0.665f, 0.175f}, {0.026f, 0.065f, 0.030f});
  return std::min(ellipsoid(p, {0.062f, 0.80f, 0.10f}, {0.024f, 0.050f, 0.028f}),
                  ellipsoid(p, {-0.05f, 0.58f, 0.165f}, {0.050f, 0.024f, 0.026f}));
}

float body(const Vec3& p, bool grief) {
  const Vec3 m{std::abs(p.x()), p.y(), p.z()};
  float d = limb(p, {0.0f, 0.02f, 0.0f}, 0.17f, {0.0f, 0.45f, 0.0f}, 0.135f);
  d = blend(d, ellipsoid(p, {0.0f, 0.64f, 0.0f}, {0.145f, 0.17f, 0.10f}), 0.10f);
  d = blend(d, limb(m, {0.0f, 0.775f, -0.01f}, 0.055f, {0.135f, 0.755f, -0.01f}, 0.055f), 0.06f);
  d = blend(d, limb(m, {0.165f, 0.74f, 0.0f}, 0.056f, {0.195f, 0.575f, 0.035f}, 0.050f), 0.04f);
  const Vec3 right_hand = grief ? Vec3(0.07f, 0.76f, 0.10f) : Vec3(0.02f, 0.63f, 0.165f);
  const Vec3 left_hand = grief ? Vec3(-0.03f, 0.58f, 0.155f) : Vec3(-0.02f, 0.63f, 0.165f);
  d = blend(d, limb(p, {0.195f, 0.575f, 0.04f}, 0.048f, right_hand, 0.036f), 0.03f);
  d = blend(d, limb(p, {-0.195f, 0.575f, 0.04f}, 0.048f, left_hand, 0.036f), 0.03f);
  d = blend(d, limb(m, {0.12f, 0.58f, 0.10f}, 0.040f, {0.13f, 0.36f, 0.10f}, 0.062f), 0.05f);  // Sleeve.
  return blend(d, hands(p, grief), 0.012f);
}

constexpr float kFold = 0.065f;

float fold(const Vec3& p) {
  const float hanging = std::atan2(p.x(), p.z()) * 2.8f + 1.2f * p.y();
  const float draped = std::hypot(p.x() + 0.10f, p.y() - 0.86f) / kFold;
  const float phase = mix(hanging, draped, smooth_step(0.40f, 0.56f, p.y()));
  return fold_profile(phase);
}

Sculpture trunk(const Robes& robes, bool grief) {
  Sculpture s;
  const auto bare = [grief](const Vec3& p) {
    const float breast = p.z() > 0.0f ? ellipse({p.x() - 0.015f, p.y()}, {0.0f, 0.80f}, {0.055f, 0.10f}) : 1.0f;
    return std::min(breast, hands(p, grief) - 0.006f);
  };
  s.distance = [grief](const Vec3& p) { return body(p, grief); };
  s.relief = [bare](const Vec3& p, float spacing) {
    return (0.016f * fold(p) - 0.006f) * smooth_step(0.0f, 0.02f, bare(p)) * shown(kFold, spacing);
  };
  s.colour = [robes, bare](const Vec3& p, float spacing) {
    // The upper robe covers one shoulder; the under robe shows on the other side.
    Spot spot(robes.outer);
    const float edge = p.y() - 0.68f - 0.9f * p.x();
    spot.lay(robes.inner, coverage(-edge, spacing) * (p.z() > -0.05f ? 1.0f : 0.0f));
    spot.lay(kGold, line_coverage(edge, 0.014f, spacing));
    spot.lay(robes.inner, coverage(p.y() - 0.06f, spacing));
    spot.darken(0.42f * (1.0f - fold(p)) * shown(kFold, spacing));
    spot.lay(robes.skin, coverage(bare(p), spacing));
    spot.lay(kPlaster, 0.25f * unit_clamp(fractal_noise(p * 8.0f, 3, 51u) + 0.1f));
    return spot.colour();
  };
  s.from = {0.0f, 0.08f, 0.0f};
  s.to = {0.0f, 0.70f, 0.0f};
  s.reach = 0.34f;
  s.front_focus = 0.45f;
  s.girth = 1.1f;
  return s;
}

}  // namespace

std::vector<Patch> mourning_disciple(const Pose& pose, std::uint32_t variety, float density) {
  const Robes& robes = robes_of(variety);
  const bool grief = variety % 3u == 1u;
  const float lean = 0.10f * (random_unit(static_cast<int>(variety), 1, 61u) - 0.5f);
  Pose standing = pose;
  standing.rotation = pose.rotation * Eigen::AngleAxisf(lean, Vec3::UnitZ()).toRotationMatrix() *
                      Eigen::AngleAxisf(0.06f, Vec3::UnitX()).toRotationMatrix();
  Pose head_pose = standing;
  head_pose.position = standing.to_room({0.0f, 0.905f, 0.025f});
  head_pose.scale = 0.078f * pose.scale;
  head_pose.rotation =
      standing.rotation *
      Eigen::AngleAxisf(1.2f * (random_unit(static_cast<int>(variety), 2, 61u) - 0.5f), Vec3::UnitY()) *
      Eigen::AngleAxisf(0.30f, Vec3::UnitX()) * Eigen::AngleAxisf(2.0f * lean, Vec3::UnitZ());
  const StatueHeadStyle face{
      .buddha = false, .skin = robes.skin, .sorrow = 1.0f, .age = random_unit(static_cast<int>(variety), 3, 61u)};
  return {wrapped(trunk(robes, grief), standing, density), wrapped(statue_head(face), head_pose, 1.5f * density)};
}

}  // namespace cyclorama::generator

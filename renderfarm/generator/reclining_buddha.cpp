// SPDX-License-Identifier: Apache-2.0
/// The reclining Buddha. Its frame has x from head (-5) to feet (+5), y up from the bed, and z towards the visitor, in
/// metres.
#include <array>

#include "renderfarm/generator/figures.h"
#include "renderfarm/generator/motifs.h"
#include "renderfarm/generator/noise.h"
#include "renderfarm/generator/paint.h"
#include "renderfarm/generator/solid.h"
#include "renderfarm/generator/statue_head.h"

namespace cyclorama::generator {
namespace {

using namespace pigment;  // NOLINT(google-build-using-namespace): colours by name, in this file only.

const Vec3 kSkin{0.86f, 0.67f, 0.43f};

const Vec3 kLeftShoulder{-2.72f, 1.62f, 0.05f};
const Vec3 kLeftElbow{-0.95f, 1.70f, 0.36f};
const Vec3 kLeftWrist{0.75f, 1.55f, 0.42f};
const Vec3 kRightShoulder{-2.60f, 0.52f, 0.25f};
const Vec3 kRightElbow{-2.30f, 0.30f, 0.88f};
const Vec3 kRightWrist{-3.35f, 0.36f, 0.92f};

float left_arm(const Vec3& p) {
  return blend(limb(p, kLeftShoulder, 0.40f, kLeftElbow, 0.29f), limb(p, kLeftElbow, 0.29f, kLeftWrist, 0.20f), 0.12f);
}

/// Returns the distance to the body alone, without the robe below it.
float torso_and_legs(const Vec3& p) {
  float d = ellipsoid(p, {-2.40f, 1.03f, 0.0f}, {1.00f, 0.92f, 0.62f});               // Chest.
  d = blend(d, ellipsoid(p, {-1.00f, 0.86f, 0.08f}, {1.20f, 0.76f, 0.60f}), 0.40f);   // Waist.
  d = blend(d, ellipsoid(p, {0.45f, 0.90f, 0.02f}, {1.15f, 0.90f, 0.66f}), 0.40f);    // Hip.
  float upper = limb(p, {0.70f, 1.18f, 0.05f}, 0.55f, {2.50f, 0.98f, 0.26f}, 0.41f);  // Left leg, on top.
  upper = blend(upper, limb(p, {2.50f, 0.98f, 0.26f}, 0.41f, {4.50f, 0.60f, 0.0f}, 0.23f), 0.20f);
  float lower = limb(p, {0.70f, 0.60f, 0.05f}, 0.58f, {2.60f, 0.44f, 0.38f}, 0.42f);  // Right leg.
  lower = blend(lower, limb(p, {2.60f, 0.44f, 0.38f}, 0.42f, {4.60f, 0.27f, 0.08f}, 0.24f), 0.20f);
  return blend(d, blend(upper, lower, 0.16f), 0.35f);
}

float body(const Vec3& p) {
  // Below its widest point the robe falls straight to the bed, spreading slightly.
  const float widest = mix(0.55f, 0.28f, smooth_step(1.5f, 4.5f, p.x()));
  const float below = std::max(0.0f, widest - p.y());
  const Vec3 q{p.x(), std::max(p.y(), widest), p.z() / (1.0f + 0.18f * below)};
  const float right_arm = limb(p, kRightShoulder, 0.42f, kRightElbow, 0.36f);
  const float whole = blend(blend(torso_and_legs(q), right_arm, 0.22f), left_arm(p), 0.14f);
  return std::max(whole, -0.05f - p.y());  // Cut off below the bed, where it is not visible.
}

/// Returns the distance from the throat over the breast; the robe's neckline is where it equals kNeckline.
float from_throat(const Vec3& p) {
  const Vec3 q = p - Vec3(-3.42f, 1.12f, 0.18f);
  return std::sqrt(q.x() * q.x() + 1.3f * q.y() * q.y() + 0.5f * q.z() * q.z());
}

constexpr float kNeckline = 0.66f;

constexpr float kFold = 0.215f;

/// Returns the phase of the folds, which hang in circles around the throat and run along the legs.
float fold_phase(const Vec3& p) {
  const float torso = from_throat(p) / kFold;
  const float middle = mix(1.0f, 0.52f, smooth_step(0.0f, 4.6f, p.x()));
  const float around = std::atan2(p.y() - middle, p.z() + 0.25f);
  const float wave = 0.55f * std::sin(1.3f * p.x() + 0.8f) + 0.35f * noise(p * 0.8f, 71u);
  const float legs = around * 5.6f + wave + 0.55f * p.x();
  return mix(torso, legs, smooth_step(-1.5f, 1.2f, p.x()));
}

float arm_share(const Vec3& p) { return smooth_step(0.16f, 0.02f, left_arm(p)); }

float fold(const Vec3& p) {
  const float cloth = fold_profile(fold_phase(p));
  const float arm = arm_share(p);
  if (arm <= 0.0f) return cloth;
  const float sleeve_phase = (0.75f * p.x() + 0.9f * p.y() - 0.5f * p.z()) / 0.23f + 0.4f * noise(p * 1.5f, 72u);
  return mix(cloth, fold_profile(sleeve_phase), arm);
}

/// Returns a positive number where cloth covers the body.
float covered(const Vec3& p) { return p.z() > -0.2f ? from_throat(p) - kNeckline : 1.0f; }

float fold_height(const Vec3& p, float spacing) {
  const float calm = 0.75f + 0.25f * noise(p * 0.7f, 73u);
  const float cloth = smooth_step(0.0f, 0.12f, covered(p));
  const float collar = 0.035f * smooth_window(0.02f, 0.19f, 0.02f, covered(p));
  return cloth * calm * 0.058f * (fold(p) - 0.45f) * shown(kFold, spacing) + collar;
}

/// Paints the patchwork of a monk's robe: panels in shades of red, separated by bands, with gold roundels.
void lay_patchwork(const Vec3& p, float spacing, Spot& spot) {
  const float along = p.x() + 0.25f * std::sin(1.1f * p.x());
  const float around = std::atan2(p.y() - 0.6f, p.z() + 0.4f) * 0.95f + 0.10f * p.x();
  const auto [row, y] = repeat(around, 0.62f);
  const auto [column, x] = repeat(along + 0.61f * static_cast<float>(cycle(row, 2)), 1.30f);
  const std::array<Vec3, 3> panels = {mix(kCinnabar, kRust, 0.25f), mix(kCinnabar, kRust, 0.60f),
                                      mix(kCinnabar, kOchre, 0.16f)};
  spot.lay(panels[static_cast<std::size_t>(cycle(column + 2 * row, 3))], 1.0f);
  const float seam = std::min(0.65f - std::abs(x), 0.31f - std::abs(y));
  spot.lay(kOchre, 0.6f * coverage(seam - 0.045f, spacing));
  spot.lay(kRust * 0.85f, 0.6f * coverage(seam - 0.028f, spacing));
  const Vec2 q{repeat(x + 0.325f, 0.65f).offset, y};
  const float r = q.norm();
  const float petals = r - 0.088f - 0.022f * std::cos(6.0f * std::atan2(q.y(), q.x()));
  spot.lay(kGold, 0.85f * coverage(petals, spacing));
  spot.lay(kRust, coverage(r - 0.055f, spacing));
  spot.lay(kGold, coverage(r - 0.032f, spacing));
}

/// Paints a hem of width `width`: blossoms on malachite between gold cords. `across` is 0 at the inner edge.
void lay_hem(float across, float along, float width, float spacing, Spot& spot) {
  const float middle = across - 0.5f * width;
  spot.lay(mix(kMalachite, kInk, 0.15f), coverage(std::abs(middle) - 0.5f * width, spacing));
  const float blossom = std::hypot(repeat(along, 1.15f * width).offset, middle);
  spot.lay(kGold, coverage(blossom - 0.30f * width, spacing));
  spot.lay(kCinnabar, coverage(blossom - 0.16f * width, spacing));
  spot.lay(kGold, line_coverage(std::abs(middle) - 0.5f * width, 0.035f, spacing));
}

constexpr float kCollar = 0.20f;     ///< Width of the under robe's hem around the breast.
constexpr float kOuterRobe = 1.36f;  ///< Distance from the throat to the outer robe's hem, which crosses the breast.

Vec3 robe_colour(const Vec3& p, float spacing) {
  Spot spot(kCinnabar);
  lay_patchwork(p, spacing, spot);
  const float over = covered(p);
  const float turn = 1.3f * std::atan2(p.y() - 1.1f, p.x() + 3.4f);
  // The under robe shows at the breast, between its own hem and the hem of the outer robe.
  const float under = from_throat(p) - kOuterRobe + 0.25f * (p.y() - 1.0f);
  if (p.z() > -0.2f) {
    spot.lay(mix(kPaleGreen, kAzurite, 0.30f), coverage(under, spacing));
    lay_hem(under, 1.5f * turn, kCollar, spacing, spot);
    lay_hem(over, turn, kCollar, spacing, spot);
  }
  // The under robe shows at the ankles; a hem is on the bed.
  const float ankles = 4.12f + 0.08f * std::sin(9.0f * p.y()) - p.x();
  spot.lay(mix(kPaleGreen, kAzurite, 0.30f), coverage(ankles, spacing));
  lay_hem(ankles, p.y(), kCollar, spacing, spot);
  lay_hem(p.y() - 0.03f, p.x(), 0.17f, spacing, spot);
  const float shade = (1.0f - fold(p)) * smooth_step(0.0f, 0.2f, over);
  spot.darken(0.48f * shade * shown(kFold, spacing));
  spot.lay(kSkin, coverage(over, spacing));
  spot.darken(0.35f * smooth_step(0.20f, 0.0f, p.y()));  // Contact with the bed.
  spot.darken(0.30f * smooth_window(-0.12f, 0.05f, 0.06f, left_arm(p)) * (1.0f - arm_share(p)));
  spot.lay(kPlaster, 0.20f * unit_clamp(fractal_noise(p * 1.6f, 4, 74u) + 0.05f));
  return spot.colour();
}

Vec3 skin_colour(const Vec3& p) {
  Spot spot(kSkin);
  spot.darken(0.12f * unit_clamp(fractal_noise(p * 3.0f, 3, 75u) + 0.2f));
  spot.darken(0.40f * smooth_step(0.22f, 0.02f, p.y()));
  return spot.colour();
}

Sculpture robe() {
  Sculpture s;
  s.distance = body;
  s.relief = fold_height;
  s.colour = robe_colour;
  s.from = {-2.45f, 0.95f, 0.0f};
  s.to = {4.25f, 0.42f, 0.05f};
  s.front = Vec3(0.0f, 0.5f, 1.0f);
  s.reach = 2.0f;
  s.front_focus = 0.45f;
  s.girth = 4.4f;
  return s;
}

/// Returns a limb of bare skin, wrapped around the axis from `from` to `to`.
Sculpture skin_part(std::function<float(const Vec3&)> distance, const Vec3& from, const Vec3& to, const Vec3& front,
                    float reach, float girth) {
  Sculpture s;
  s.distance = std::move(distance);
  s.colour = [](const Vec3& p, float) { return skin_colour(p); };
  s.from = from;
  s.to = to;
  s.front = front;
  s.reach = reach;
  s.girth = girth;
  return s;
}

/// Returns the right forearm, and the hand on which the cheek rests.
Sculpture right_hand() {
  return skin_part(
      [](const Vec3& p) {
        float d = limb(p, kRightElbow + Vec3(0.05f, 0.0f, 0.0f), 0.26f, kRightWrist, 0.17f);
        d = blend(d, ellipsoid(p, {-3.72f, 0.40f, 0.86f}, {0.36f, 0.13f, 0.23f}), 0.12f);
        for (int i = 0; i < 4; ++i) {
          const float k = static_cast<float>(i);
          const Vec3 root{-3.95f, 0.42f, 0.99f - 0.10f * k};
          const Vec3 tip = root + Vec3(-0.52f + 0.05f * std::abs(k - 1.0f), 0.06f, -0.16f);
          d = blend(d, limb(p, root, 0.068f, tip, 0.052f), 0.02f);
        }
        return blend(d, limb(p, {-3.55f, 0.48f, 1.02f}, 0.075f, {-3.86f, 0.62f, 1.02f}, 0.055f), 0.04f);  // Thumb.
      },
      kRightElbow, {-4.05f, 0.42f, 0.84f}, Vec3(0.0f, 0.6f, 1.0f), 0.75f, 1.5f);
}

/// Returns the left hand, which lies on the thigh.
Sculpture left_hand() {
  return skin_part(
      [](const Vec3& p) {
        float d = limb(p, kLeftWrist - Vec3(0.15f, 0.0f, 0.0f), 0.16f, {1.10f, 1.53f, 0.44f}, 0.14f);
        d = blend(d, ellipsoid(p, {1.20f, 1.53f, 0.44f}, {0.30f, 0.11f, 0.22f}), 0.10f);
        for (int i = 0; i < 4; ++i) {
          const float k = static_cast<float>(i);
          const Vec3 root{1.38f, 1.57f - 0.035f * k * k * 0.5f, 0.30f + 0.095f * k};
          const Vec3 tip = root + Vec3(0.52f - 0.06f * std::abs(k - 1.0f), -0.10f, 0.02f * k);
          d = blend(d, limb(p, root, 0.066f, tip, 0.050f), 0.02f);
        }
        return blend(d, limb(p, {1.05f, 1.50f, 0.62f}, 0.07f, {1.38f, 1.40f, 0.70f}, 0.05f), 0.05f);  // Thumb.
      },
      kLeftWrist, {1.45f, 1.53f, 0.44f}, Vec3(0.0f, 0.6f, 1.0f), 0.75f, 1.4f);
}

/// Returns a foot, with the sole to +x and the toes to +z.
Sculpture foot(float height, float back) {
  return skin_part(
      [height, back](const Vec3& p) {
        const Vec3 q = p - Vec3(back, height, 0.0f);
        float d = limb(q, {-0.30f, 0.02f, -0.02f}, 0.20f, {0.02f, 0.0f, -0.10f}, 0.20f);
        d = blend(d, sphere(q, {0.10f, 0.0f, -0.16f}, 0.165f), 0.1f);
        d = blend(d, ellipsoid(q, {0.07f, 0.0f, 0.22f}, {0.13f, 0.175f, 0.36f}), 0.16f);
        d = blend(d, ellipsoid(q, {0.13f, 0.0f, 0.42f}, {0.10f, 0.19f, 0.17f}), 0.08f);
        for (int i = 0; i < 5; ++i) {
          const float k = static_cast<float>(i);
          const float size = i == 0 ? 0.062f : 0.046f - 0.003f * k;
          const Vec3 toe{0.14f, -0.145f + 0.078f * k, 0.62f - 0.022f * k * k * 0.6f};
          d = blend(d, limb(q, toe - Vec3(0.0f, 0.0f, 0.12f), size, toe, size), 0.02f);
        }
        return d;
      },
      {back + 0.02f, height, -0.10f}, {back + 0.08f, height, 0.45f}, Vec3::UnitX(), 0.62f, 1.3f);
}

Sculpture pillow() {
  Sculpture s;
  s.distance = [](const Vec3& p) {
    const float sag = 0.06f * std::exp(-(p - Vec3(-4.2f, 0.4f, 0.2f)).squaredNorm() / 0.3f);
    return rounded_box(p, {-4.18f, 0.19f, 0.10f}, {0.80f, 0.21f, 0.98f}, 0.17f) + sag;
  };
  s.colour = [](const Vec3& p, float spacing) {
    Spot spot(brocade({p.x() + 0.12f, p.z() + p.y()}, kPaleGreen, kWhite, spacing));
    const float end = std::abs(p.z() - 0.10f) - 0.80f;
    spot.lay(kCinnabar, coverage(-end, spacing));
    spot.lay(kGold, line_coverage(end, 0.04f, spacing));
    spot.darken(0.5f * smooth_step(0.16f, 0.0f, p.y()));
    return spot.colour();
  };
  s.from = {-4.18f, 0.19f, -0.5f};
  s.to = {-4.18f, 0.19f, 0.7f};
  s.front = Vec3(1.0f, 1.0f, 0.0f);
  s.reach = 1.2f;
  s.girth = 2.6f;
  return s;
}

Pose head_pose() {
  Pose pose;
  pose.position = {-4.13f, 1.04f, 0.16f};
  pose.scale = 0.74f;
  Eigen::Matrix3f lying;  // Crown to -x, left ear up, face to +z.
  lying.col(0) = Vec3::UnitY();
  lying.col(1) = -Vec3::UnitX();
  lying.col(2) = Vec3::UnitZ();
  pose.rotation =
      lying * (Eigen::AngleAxisf(0.16f, Vec3::UnitY()) * Eigen::AngleAxisf(0.14f, Vec3::UnitX())).toRotationMatrix();
  return pose;
}

Pose composed(const Pose& outer, const Pose& inner) {
  return {outer.to_room(inner.position), outer.rotation * inner.rotation, outer.scale * inner.scale};
}

}  // namespace

std::vector<Patch> reclining_buddha(const Pose& pose, float density) {
  Pose nimbus;
  nimbus.position = {-4.35f, 1.30f, -0.62f};
  return {wrapped(robe(), pose, 1.25f * density),
          wrapped(statue_head({.skin = kSkin}), composed(pose, head_pose()), 2.9f * density),
          wrapped(right_hand(), pose, 1.1f * density),
          wrapped(left_hand(), pose, 1.1f * density),
          wrapped(foot(0.22f, 4.72f), pose, 1.1f * density),
          wrapped(foot(0.57f, 4.66f), pose, 1.1f * density),
          wrapped(pillow(), pose, 0.8f * density),
          nimbus_disc(composed(pose, nimbus), {1.45f, 1.45f}, 0, 1.7f * density)};
}

}  // namespace cyclorama::generator

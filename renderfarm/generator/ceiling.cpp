// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/generator/chamber.h"
#include "renderfarm/generator/motifs.h"
#include "renderfarm/generator/noise.h"
#include "renderfarm/generator/paint.h"

namespace cyclorama::generator {
namespace {

constexpr float kRise = kTopHeight - kWallHeight;
constexpr float kArc = 3.85f;  ///< Length of the cove's profile, a quarter of an ellipse.
constexpr float kLoss = 0.10f;

/// Returns the height of the rock under the ceiling's plaster, positive downwards into the room.
float height_of(const Vec3& p3, const Vec2& p, const Age& age, std::uint32_t seed) {
  return 0.06f * fractal_noise(p3 * 0.5f, 3, seed + 111u) + 0.008f * noise(p3 * 4.0f, seed + 112u) -
         age.plaster_lost * (0.012f + 0.03f * chisel_marks(p, seed + 113u));
}

/// Returns the colour at `s` metres up the profile of a cove.
Vec3 cove_colour(float x, float s, float spacing) {
  constexpr float kGridTo = 0.24f + 5.0f * kCellHeight;
  constexpr float kBandTo = kGridTo + 0.26f;
  constexpr float kSkyTo = kArc - 0.24f;
  if (s < 0.24f) return petal_band({x, s}, 0.24f, spacing);
  if (s < kGridTo) return thousand_buddhas({x, s - 0.24f}, spacing);
  if (s < kBandTo) return scroll_band({x, s - kGridTo}, kBandTo - kGridTo, spacing);
  if (s < kSkyTo) return flying_apsaras({x, s - kBandTo}, kSkyTo - kBandTo, spacing);
  return scroll_band({x, std::min(s - kSkyTo, 0.24f)}, 0.24f, spacing);
}

/// All four coves have the same number of rows, so that their vertices at the hips are identical.
constexpr float kCoveDensity = 0.34f;

/// Returns the share of the rock's roughness that remains `edge` metres from the line where two patches meet.
float freedom(float edge) { return smooth_step(0.0f, 0.25f, edge); }

/// Returns one of the four coves: `along` runs along its wall, `inward` from the wall into the room.
Patch cove(const Vec3& origin, const Vec3& along, const Vec3& inward, float half_length, std::uint32_t seed) {
  Patch patch;
  patch.width_m = 2.0f * half_length;
  patch.height_m = kArc;
  patch.density = kCoveDensity;
  patch.at = [=](float u, float v, float spacing) {
    const float angle = 0.5f * kPi * v;
    const float depth = kCoveDepth * (1.0f - std::cos(angle));
    const float half = half_length - depth;
    const float x = mix(-half, half, u);
    const Vec3 plane = origin + x * along + depth * inward + kRise * std::sin(angle) * Vec3::UnitY();
    const Vec3 out = (std::cos(angle) / kCoveDepth * inward - std::sin(angle) / kRise * Vec3::UnitY()).normalized();
    const float s = v * kArc;
    const Age age = age_of(plane, kLoss, seed);
    Spot spot(aged(cove_colour(x, s, spacing), age, plane, kLoss, seed));
    spot.darken(0.30f * smooth_step(0.45f, 0.0f, half - std::abs(x)));
    spot.darken(0.22f * v);  // Soot of a thousand years of lamps.
    const float free = freedom(std::min({half - std::abs(x), s, kArc - s}));
    return Surfel{plane + free * height_of(plane, {x, s}, age, seed) * out, spot.colour()};
  };
  turn_towards(patch, Vec3(0.0f, 2.0f, 0.0f));
  return patch;
}

Patch top(std::uint32_t seed) {
  constexpr float kHalfX = kHalfLength - kCoveDepth;
  constexpr float kHalfZ = kHalfDepth - kCoveDepth;
  Patch patch;
  patch.width_m = 2.0f * kHalfX;
  patch.height_m = 2.0f * kHalfZ;
  patch.density = 0.34f;
  patch.at = [=](float u, float v, float spacing) {
    const Vec2 p{mix(-kHalfX, kHalfX, u), mix(-kHalfZ, kHalfZ, v)};
    const Vec3 plane{p.x(), kTopHeight, p.y()};
    // Five lanterns side by side, slightly longer than wide.
    constexpr float kStep = 2.0f * kHalfX / 5.0f;
    const float x = repeat(p.x() + 0.5f * kStep, kStep).offset * 2.0f * kHalfZ / kStep;
    const Age age = age_of(plane, kLoss, seed);
    Spot spot(aged(lantern({x, p.y()}, kHalfZ, spacing), age, plane, kLoss, seed));
    spot.darken(0.22f);
    // Each square of a lantern is a step higher than the square around it.
    const float in = kHalfZ - std::max(std::abs(x), std::abs(p.y()));
    const float diagonal = 0.68f * kHalfZ - (std::abs(x) + std::abs(p.y())) * 0.7071f;
    const float steps = 0.05f * smooth_step(0.10f, 0.16f, in) + 0.06f * smooth_step(0.0f, 0.05f, diagonal);
    const float free = freedom(std::min(kHalfX - std::abs(p.x()), kHalfZ - std::abs(p.y())));
    return Surfel{plane + free * (steps - height_of(plane, p, age, seed)) * Vec3::UnitY(), spot.colour()};
  };
  turn_towards(patch, Vec3(0.0f, 2.0f, 0.0f));
  return patch;
}

}  // namespace

std::vector<Patch> ceiling(std::uint32_t seed) {
  const Vec3 up{0.0f, kWallHeight, 0.0f};
  return {cove(up + Vec3(0.0f, 0.0f, -kHalfDepth), Vec3::UnitX(), Vec3::UnitZ(), kHalfLength, seed),
          cove(up + Vec3(0.0f, 0.0f, kHalfDepth), -Vec3::UnitX(), -Vec3::UnitZ(), kHalfLength, seed),
          cove(up + Vec3(-kHalfLength, 0.0f, 0.0f), -Vec3::UnitZ(), Vec3::UnitX(), kHalfDepth, seed),
          cove(up + Vec3(kHalfLength, 0.0f, 0.0f), Vec3::UnitZ(), -Vec3::UnitX(), kHalfDepth, seed), top(seed)};
}

}  // namespace cyclorama::generator

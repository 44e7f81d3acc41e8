// SPDX-License-Identifier: Apache-2.0
/// Floor, corridor and altar.
#include <array>

#include "renderfarm/generator/chamber.h"
#include "renderfarm/generator/motifs.h"
#include "renderfarm/generator/noise.h"
#include "renderfarm/generator/paint.h"

namespace cyclorama::generator {
namespace {

using namespace pigment;  // NOLINT(google-build-using-namespace): colours by name, in this file only.

Surfel ground(const Vec2& p, float spacing, std::uint32_t seed) {
  const Vec3 plane{p.x(), 0.0f, p.y()};
  float relief = 0.0f;
  Spot spot(floor_tile(p, spacing, &relief));
  const float wear = smooth_step(-0.2f, 0.5f, fractal_noise(plane * 0.5f, 3, seed + 121u));
  const float crack = crack_lines(plane * 0.9f, seed + 122u);
  spot.lay(Vec3(0.55f, 0.47f, 0.38f), 0.45f * wear);
  spot.darken(0.18f * unit_clamp(fractal_noise(plane * 2.5f, 3, seed + 123u) + 0.3f));
  spot.darken(0.55f * crack);
  spot.darken(0.45f * smooth_step(0.5f, 0.0f, p.y() - kAltarFront));
  spot.darken(0.35f * smooth_step(0.5f, 0.0f, kHalfLength - std::abs(p.x())));
  const float height =
      0.010f * fractal_noise(plane * 0.7f, 3, seed + 124u) + 0.008f * relief * (1.0f - 0.7f * wear) - 0.01f * crack;
  return {plane + height * Vec3::UnitY(), spot.colour()};
}

/// Returns a face of rough rock from `corner`, spanned by `across` and `up`; it is smooth at the edge along `up`
/// through `corner`.
Patch rough_face(const Vec3& corner, const Vec3& across, const Vec3& up, const Vec3& inward, const Vec3& tint,
                 std::uint32_t seed) {
  Patch patch;
  patch.width_m = across.norm();
  patch.height_m = up.norm();
  patch.density = 0.26f;
  patch.at = [=](float u, float v, float) {
    const Vec3 plane = corner + u * across + v * up;
    const Vec2 p{u * across.norm(), v * up.norm()};
    const float free = smooth_step(0.0f, 0.08f, u);
    const float marks = chisel_marks(p, seed + 131u);
    const float height = 0.07f * fractal_noise(plane * 0.9f, 4, seed + 132u) - 0.03f * marks;
    const float light = 0.85f + 0.25f * fractal_noise(plane * 3.0f, 3, seed + 133u) - 0.15f * marks;
    return Surfel{plane + free * height * inward, Vec3(tint * light)};
  };
  turn_towards(patch, corner + 0.5f * across + 0.5f * up + inward);
  return patch;
}

const Vec3 kDarkRock{0.40f, 0.34f, 0.28f};
const Vec3 kDaylit{0.70f, 0.75f, 0.78f};  ///< Colour of the white cloth at the open end of the corridor.

void add_corridor(std::uint32_t seed, std::vector<Patch>& patches) {
  // The mouth's edges are straight and identical to the wall's, so that there is no crack around the door.
  const float mouth = kHalfDepth;
  const float length = kCorridorEnd - mouth + 0.2f;
  const Vec3 down{0.0f, -0.2f, 0.0f};
  const Vec3 rise{0.0f, kDoorHeight + 0.4f, 0.0f};
  const Vec3 deep{0.0f, 0.0f, length};
  patches.push_back(rough_face(Vec3(-kDoorHalfWidth, 0.0f, mouth) + down, deep, rise, Vec3::UnitX(), kDarkRock, seed));
  patches.push_back(
      rough_face(Vec3(kDoorHalfWidth, 0.0f, mouth) + down, deep, rise, -Vec3::UnitX(), kDarkRock, seed + 1u));
  const Vec3 wide{2.0f * kDoorHalfWidth + 0.6f, 0.0f, 0.0f};
  patches.push_back(
      rough_face({-kDoorHalfWidth - 0.3f, kDoorHeight, mouth}, deep, wide, -Vec3::UnitY(), kDarkRock, seed + 2u));
  patches.push_back(
      rough_face({-kDoorHalfWidth - 0.3f, -0.2f, kCorridorEnd}, wide, rise, -Vec3::UnitZ(), kDaylit, seed + 3u));
}

/// Profile of the altar from its foot to its top, as (forward, up).
struct Knot {
  float forward;
  float up;
};
constexpr std::array<Knot, 12> kProfile = {{{0.16f, -0.12f},
                                            {0.16f, 0.10f},
                                            {0.13f, 0.12f},
                                            {0.10f, 0.14f},
                                            {0.04f, 0.23f},
                                            {0.0f, 0.25f},
                                            {0.0f, 0.55f},
                                            {0.03f, 0.57f},
                                            {0.10f, 0.68f},
                                            {0.14f, 0.70f},
                                            {0.14f, 0.79f},
                                            {0.12f, 0.80f}}};

/// Returns the point of the profile at the fraction `v` of its length.
Knot profile_at(float v) {
  const auto length_of = [](std::size_t i) {
    return std::hypot(kProfile[i + 1].forward - kProfile[i].forward, kProfile[i + 1].up - kProfile[i].up);
  };
  float whole = 0.0f;
  for (std::size_t i = 0; i + 1 < kProfile.size(); ++i) whole += length_of(i);
  float left = v * whole;
  std::size_t i = 0;
  while (i + 2 < kProfile.size() && left > length_of(i)) left -= length_of(i++);
  const float t = unit_clamp(left / length_of(i));
  return {mix(kProfile[i].forward, kProfile[i + 1].forward, t), mix(kProfile[i].up, kProfile[i + 1].up, t)};
}

Vec3 front_colour(float x, float up, float spacing) {
  if (up < 0.12f) return mix(kRust, kPlaster, 0.4f);
  if (up < 0.25f) return petal_band({x, 0.25f - up}, 0.13f, spacing);
  if (up > 0.685f) return scroll_band({x, up - 0.685f}, 0.115f, spacing);
  if (up > 0.56f) return petal_band({x, up - 0.56f}, 0.13f, spacing);
  // Arched panels with a flaming jewel in each.
  const auto [i, dx] = repeat(x, 0.72f);
  Spot spot(kRust);
  const float y = up - 0.26f;
  const float panel = std::max(ellipse({dx, y}, {0.0f, 0.0f}, {0.31f, 0.27f}), -y);
  spot.lay(kWhite, coverage(panel, spacing));
  spot.lay(cycle(i, 2) == 0 ? kAzurite : kMalachite, coverage(panel + 0.02f, spacing));
  const float flame = ellipse({dx * (1.0f + y * 2.0f), y}, {0.0f, 0.12f}, {0.10f, 0.11f});
  spot.lay(kOchre, coverage(flame, spacing));
  spot.lay(kCinnabar, coverage(flame + 0.025f, spacing));
  spot.lay(kWhite, coverage(Vec2(dx, y - 0.10f).norm() - 0.04f, spacing));
  return spot.colour();
}

Patch altar_front(std::uint32_t seed) {
  constexpr float kHalf = kHalfLength + 0.3f;
  Patch patch;
  patch.width_m = 2.0f * kHalf;
  patch.height_m = 1.15f;
  patch.density = 0.95f;
  patch.at = [=](float u, float v, float spacing) {
    const Knot knot = profile_at(v);
    const Vec3 plane{mix(-kHalf, kHalf, u), knot.up, kAltarFront + knot.forward};
    const float loss = 0.20f + 0.25f * smooth_step(0.3f, 0.0f, knot.up);
    const Age age = age_of(plane, loss, seed);
    Spot spot(aged(front_colour(plane.x(), knot.up, spacing), age, plane, loss, seed));
    const float shelter = smooth_step(0.12f, 0.0f, knot.forward);  // The ledge casts a shadow below it.
    spot.darken(0.30f * shelter + 0.3f * smooth_step(0.15f, 0.0f, knot.up));
    const float height = 0.012f * fractal_noise(plane * 2.0f, 3, seed + 141u) - 0.012f * age.plaster_lost;
    return Surfel{plane + height * Vec3::UnitZ(), spot.colour()};
  };
  turn_towards(patch, Vec3(0.0f, 1.0f, 2.0f));
  return patch;
}

Patch altar_top(std::uint32_t seed) {
  constexpr float kHalf = kHalfLength + 0.3f;
  constexpr float kFront = kAltarFront + kProfile.back().forward + 0.005f;
  constexpr float kBack = -kHalfDepth - 0.9f;  // Extends through the niches' backs.
  Patch patch;
  patch.width_m = 2.0f * kHalf;
  patch.height_m = kFront - kBack;
  patch.density = 0.34f;
  patch.at = [=](float u, float v, float spacing) {
    const Vec3 plane{mix(-kHalf, kHalf, u), kAltarHeight, mix(kBack, kFront, v)};
    const float border = plane.z() - (kFront - 0.30f);
    Spot spot(brocade({plane.x(), plane.z()}, kRust, kOchre, spacing));
    spot.lay(scroll_band({plane.x(), std::max(border, 0.0f)}, 0.30f, spacing), coverage(-border, spacing));
    const Age age = age_of(plane, 0.05f, seed);
    const Vec3 colour = aged(spot.colour(), age, plane, 0.1f, seed);
    const float near_edge = smooth_step(kFront - 0.08f, kFront, plane.z());
    const float height = (1.0f - near_edge) * (0.010f * fractal_noise(plane * 1.1f, 3, seed + 151u));
    return Surfel{plane + height * Vec3::UnitY(), colour};
  };
  turn_towards(patch, Vec3(0.0f, 3.0f, 0.0f));
  return patch;
}

}  // namespace

std::vector<Patch> floor_and_corridor(std::uint32_t seed) {
  constexpr float kHalf = kHalfLength + 0.3f;
  constexpr float kFrom = kAltarFront - 0.25f;
  Patch room;
  room.width_m = 2.0f * kHalf;
  room.height_m = kHalfDepth + 0.3f - kFrom;
  room.density = 0.38f;
  room.at = [=](float u, float v, float spacing) {
    return ground({mix(-kHalf, kHalf, u), mix(kFrom, kHalfDepth + 0.3f, v)}, spacing, seed);
  };
  turn_towards(room, Vec3(0.0f, 2.0f, 0.0f));
  Patch way;
  way.width_m = 2.0f * kDoorHalfWidth + 0.4f;
  way.height_m = kCorridorEnd - kHalfDepth + 0.2f;
  way.density = 0.26f;
  way.at = [=](float u, float v, float spacing) {
    Surfel surfel =
        ground({mix(-kDoorHalfWidth - 0.2f, kDoorHalfWidth + 0.2f, u), mix(kHalfDepth - 0.1f, kCorridorEnd + 0.2f, v)},
               spacing, seed);
    surfel.position.y() -= 0.012f;  // Keeps it below the room's floor where both overlap.
    return surfel;
  };
  turn_towards(way, Vec3(0.0f, 2.0f, 5.0f));
  std::vector<Patch> patches = {room, way};
  add_corridor(seed, patches);
  return patches;
}

std::vector<Patch> altar(std::uint32_t seed) { return {altar_front(seed), altar_top(seed)}; }

}  // namespace cyclorama::generator

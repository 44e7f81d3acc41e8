// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/generator/interior.h"

#include <fmt/format.h>

#include "renderfarm/generator/figures.h"
#include "renderfarm/generator/motifs.h"
#include "renderfarm/generator/noise.h"
#include "renderfarm/generator/paint.h"
#include "renderfarm/generator/sculpture.h"
#include "renderfarm/generator/solid.h"

namespace cyclorama::generator {
namespace {

// The hall: x across, z along the hall, y up; the origin is in the middle of the floor.
constexpr float kHalfWidth = 7.0f;
constexpr float kHalfLength = 11.0f;
constexpr float kHeight = 6.0f;
constexpr float kAisle = 4.6f;  ///< Distance of the columns from the middle.
constexpr int kColumnsPerRow = 5;
constexpr float kColumnPitch = 4.0f;
constexpr float kLampHeight = 5.86f;
constexpr float kLampArea = 9.0f;  ///< Total area of all lamps in square metres.
constexpr float kLuminance = 24.0f;
constexpr float kTrayDepth = 0.02f;
/// Length by which walls extend beyond floor and ceiling, so that no corner is open.
constexpr float kOverlap = 0.15f;

const Vec3 kWallPaint{0.80f, 0.77f, 0.71f};
const Vec3 kRedWall{0.66f, 0.33f, 0.27f};
const Vec3 kStone{0.74f, 0.70f, 0.63f};
const Vec3 kWood{0.45f, 0.29f, 0.17f};
const Vec3 kCeilingPaint{0.86f, 0.85f, 0.82f};

/// Colour of a surface and its height above the plane.
struct Finish {
  Vec3 colour;
  float height = 0.0f;
};
/// Returns a flat piece from `corner`, spanned by `across` and `up`. `finish` receives a position on it in metres and
/// returns the finish, with the height towards `inward`.
template <typename Make>
Patch panel(const Vec3& corner, const Vec3& across, const Vec3& up, const Vec3& inward, float density, Make finish) {
  Patch patch;
  patch.width_m = across.norm();
  patch.height_m = up.norm();
  patch.density = density;
  patch.at = [=](float u, float v, float spacing) {
    const Finish made = finish(Vec2(u * across.norm(), v * up.norm()), spacing);
    return Surfel{corner + u * across + v * up + made.height * inward, made.colour};
  };
  turn_towards(patch, corner + 0.5f * across + 0.5f * up + inward);
  return patch;
}

/// Returns the finish of a wall: plaster above, a stone wainscot below, and a row of paintings.
Finish wall_finish(const Vec2& p, float spacing, const Vec3& paint, std::uint32_t seed) {
  const Vec3 place{p.x(), p.y(), 0.0f};
  Spot spot(paint * (1.0f + 0.06f * fractal_noise(place * 1.7f, 3, seed)));
  float height = 0.004f * fractal_noise(place * 6.0f, 4, seed + 1u);
  const float base = 1.0f + kOverlap;
  spot.lay(kStone, coverage(p.y() - base, spacing));
  height += 0.05f * smooth_step(base + 0.03f, base - 0.03f, p.y());
  const Repeat painting = repeat(p.x(), 3.0f);
  const Vec2 q{painting.offset, p.y() - 2.7f};
  const float frame = box(q, Vec2::Zero(), {0.95f, 0.75f});
  spot.lay(pigment::kGold, coverage(frame, spacing));
  height += 0.06f * smooth_step(0.02f, -0.02f, frame) - 0.04f * smooth_step(-0.08f, -0.12f, frame);
  const float canvas = coverage(frame + 0.1f, spacing);
  const Vec3 scene = thousand_buddhas(q + Vec2(3.0f * static_cast<float>(painting.index), 1.0f), spacing);
  spot.lay(scene, canvas);
  return {spot.colour(), height};
}

std::vector<Patch> walls(std::uint32_t seed) {
  const float foot = -kOverlap;
  const Vec3 up{0.0f, kHeight + 2.0f * kOverlap, 0.0f};
  const auto make = [&](const Vec3& corner, const Vec3& across, const Vec3& inward, const Vec3& paint,
                        std::uint32_t which) {
    return panel(corner, across, up, inward, 1.0f, [=](const Vec2& p, float spacing) {
      Finish made = wall_finish(p, spacing, paint, seed + 301u + 10u * which);
      // Flat at the edges, which neighbouring walls share.
      made.height *= smooth_step(0.0f, 0.3f, std::min(p.x(), across.norm() - p.x()));
      return made;
    });
  };
  const Vec3 along{0.0f, 0.0f, 2.0f * kHalfLength};
  const Vec3 across{2.0f * kHalfWidth, 0.0f, 0.0f};
  return {make({-kHalfWidth, foot, -kHalfLength}, along, Vec3::UnitX(), kWallPaint, 0),
          make({kHalfWidth, foot, -kHalfLength}, along, -Vec3::UnitX(), kWallPaint, 1),
          make({-kHalfWidth, foot, -kHalfLength}, across, Vec3::UnitZ(), kRedWall, 2),
          make({-kHalfWidth, foot, kHalfLength}, across, -Vec3::UnitZ(), kRedWall, 3)};
}

std::vector<Patch> floor_and_ceiling(std::uint32_t seed) {
  const Vec3 across{2.0f * (kHalfWidth + kOverlap), 0.0f, 0.0f};
  const Vec3 along{0.0f, 0.0f, 2.0f * (kHalfLength + kOverlap)};
  const Vec3 corner{-kHalfWidth - kOverlap, 0.0f, -kHalfLength - kOverlap};
  const auto floor_finish = [seed](const Vec2& p, float spacing) {
    float relief = 0.0f;
    Spot spot(floor_tile(p, spacing, &relief));
    spot.darken(0.1f * unit_clamp(fractal_noise(Vec3(p.x(), 0.0f, p.y()), 3, seed + 341u) + 0.3f));
    return Finish{spot.colour(), 0.004f * relief};
  };
  const auto ceiling_finish = [seed](const Vec2& p, float) {
    // Coffers between flat ribs; always above the lamps.
    const Repeat x = repeat(p.x(), 1.43f);
    const Repeat z = repeat(p.y(), 1.49f);
    const float edge = box({x.offset, z.offset}, Vec2::Zero(), {0.6f, 0.6f});
    const float rib = smooth_step(-0.04f, 0.0f, edge);
    const Vec3 place{p.x(), kHeight, p.y()};
    return Finish{kCeilingPaint * (1.0f + 0.04f * noise(place * 3.0f, seed + 351u)),
                  0.07f * rib + 0.003f * fractal_noise(place * 9.0f, 3, seed + 352u)};
  };
  return {panel(corner, across, along, Vec3::UnitY(), 0.8f, floor_finish),
          panel(corner + kHeight * Vec3::UnitY(), across, along, -Vec3::UnitY(), 0.8f, ceiling_finish)};
}

/// Returns a solid of revolution that stands on the floor. `radius` is a function of the height in metres; `cut`, a
/// function of angle and height, is subtracted from it.
template <typename Radius, typename Cut>
Patch lathed(const Vec3& foot, float height, float widest, float density, const Vec3& colour, std::uint32_t seed,
             Radius radius, Cut cut) {
  Patch patch;
  patch.width_m = 2.0f * kPi * widest;
  patch.height_m = height;
  patch.density = density;
  patch.closed = true;
  patch.at = [=](float u, float v, float) {
    const float angle = 2.0f * kPi * u;
    const float y = v * height;
    const Vec3 around{std::cos(angle), 0.0f, std::sin(angle)};
    const Vec3 p = foot + y * Vec3::UnitY() + std::max(1e-3f, radius(y) - cut(angle, y)) * around;
    const float vein = fractal_noise(p * 2.3f, 4, seed);
    return Surfel{p, Vec3(colour * (1.0f + 0.16f * vein))};
  };
  turn_towards(patch, foot + 0.5f * height * Vec3::UnitY(), true);
  return patch;
}

std::vector<Patch> columns(std::uint32_t seed) {
  std::vector<Patch> patches;
  const auto radius = [](float y) {
    const float shaft = 0.34f - 0.05f * y / kHeight;
    const float base = 0.14f * smooth_step(0.32f, 0.22f, y);
    const float capital = 0.20f * smooth_step(kHeight - 0.7f, kHeight - 0.3f, y);
    return shaft + base + capital;
  };
  const auto flutes = [](float angle, float y) {
    const float on_shaft = smooth_step(0.35f, 0.45f, y) * smooth_step(kHeight - 0.7f, kHeight - 0.8f, y);
    return 0.025f * on_shaft * std::abs(std::sin(10.0f * angle));
  };
  for (int i = 0; i < 2 * kColumnsPerRow; ++i) {
    const float side = i % 2 == 0 ? -kAisle : kAisle;
    const auto row = static_cast<float>(i / 2 - kColumnsPerRow / 2);
    const auto which = static_cast<std::uint32_t>(i);
    patches.push_back(lathed({side, -0.02f, row * kColumnPitch}, kHeight + 0.04f, 0.4f, 1.0f, kStone,
                             seed + 361u + which, radius, flutes));
  }
  return patches;
}

Sculpture block(const Vec3& half, const Vec3& colour, std::uint32_t seed) {
  Sculpture s;
  s.distance = [half](const Vec3& p) { return rounded_box(p, {0.0f, half.y(), 0.0f}, half, 0.02f); };
  s.relief = [seed](const Vec3& p, float) { return 0.0015f * fractal_noise(p * 14.0f, 3, seed); };
  s.colour = [=](const Vec3& p, float) {
    return Vec3(colour * (1.0f + 0.12f * fractal_noise(p * 4.0f, 3, seed + 1u)));
  };
  // The axis is along x if the block is wider than high, else vertical.
  const bool is_long = half.x() > half.y();
  const float inset = 0.3f * half.minCoeff();
  s.from = is_long ? Vec3(-half.x() + inset, half.y(), 0.0f) : Vec3(0.0f, inset, 0.0f);
  s.to = is_long ? Vec3(half.x() - inset, half.y(), 0.0f) : Vec3(0.0f, 2.0f * half.y() - inset, 0.0f);
  s.reach = 2.0f * half.maxCoeff();
  s.girth = 4.0f * (half.x() + half.z());
  return s;
}

Patch vase(const Vec3& foot, std::uint32_t seed) {
  const float belly = 0.20f + 0.08f * random_unit(1, 2, seed);
  const float waves = 8.0f + std::floor(6.0f * random_unit(3, 4, seed));
  const auto radius = [belly](float y) {
    const float t = y / 0.85f;
    const float body = belly * std::pow(std::sin(kPi * (0.12f + 0.74f * t)), 0.8f);
    return body + 0.10f * smooth_step(0.85f, 1.0f, t) - 0.02f * smooth_step(0.06f, 0.0f, t);
  };
  const auto relief = [waves](float angle, float y) {
    return 0.008f * std::sin(waves * angle + 14.0f * y) * smooth_step(0.05f, 0.2f, y) * smooth_step(0.8f, 0.6f, y);
  };
  const Vec3 colour = mix(pigment::kPaleBlue, pigment::kCinnabar, random_unit(5, 6, seed));
  return lathed(foot, 0.85f, 0.25f, 1.6f, colour, seed, radius, relief);
}

void append(std::vector<Patch>&& from, std::vector<Patch>& to) {
  for (Patch& patch : from) to.push_back(std::move(patch));
}

/// Returns the exhibits between the columns and on the hall's axis.
std::vector<Patch> exhibits(std::uint32_t seed) {
  constexpr float kPedestal = 0.55f;  ///< Half of the pedestal's height.
  constexpr float kDensity = 1.5f;
  std::vector<Patch> patches;
  for (int i = 0; i < 12; ++i) {
    const auto which = static_cast<std::uint32_t>(i);
    const bool is_beside = i < 8;
    const float x = !is_beside ? 0.0f : i % 2 == 0 ? -kAisle : kAisle;
    const float z =
        is_beside ? (static_cast<float>(i / 2) - 1.5f) * kColumnPitch : -8.0f + 3.6f * static_cast<float>(i - 8);
    const float heading = !is_beside ? 0.0f : i % 2 == 0 ? 0.5f * kPi : -0.5f * kPi;
    const Vec3 foot{x, 0.0f, z};
    patches.push_back(
        wrapped(block({0.36f, kPedestal, 0.36f}, kStone, seed + 401u + which), standing_at(foot, heading, 1.0f), 1.0f));
    const Vec3 top = foot + (2.0f * kPedestal - 0.003f) * Vec3::UnitY();
    if (i % 3 == 1) {
      patches.push_back(vase(top, seed + 421u + which));
    } else if (i % 3 == 2) {
      append(mourning_disciple(standing_at(top, heading, 0.95f), which, kDensity), patches);
    } else {
      append(seated_buddha(standing_at(top + 0.2f * Vec3::UnitY(), heading, 0.9f), which, kDensity), patches);
    }
  }
  return patches;
}

std::vector<Patch> benches(std::uint32_t seed) {
  std::vector<Patch> patches;
  for (int i = 0; i < 6; ++i) {
    const auto which = static_cast<std::uint32_t>(i);
    const float x = i % 2 == 0 ? -2.2f : 2.2f;
    const float z = -6.0f + 5.5f * static_cast<float>(i / 2);
    const float heading = 0.5f * kPi;
    patches.push_back(wrapped(block({0.9f, 0.04f, 0.22f}, kWood, seed + 441u + which),
                              standing_at({x, 0.40f, z}, heading, 1.0f), 0.8f));
    for (const float end : {-0.7f, 0.7f}) {
      patches.push_back(wrapped(block({0.04f, 0.205f, 0.18f}, kWood, seed + 451u + which),
                                standing_at({x, 0.0f, z + end}, heading, 1.0f), 0.8f));
    }
  }
  return patches;
}

/// Returns a black tray over a lamp. Its rim is in the lamp's plane, so that every renderer shows black above the lamp.
Patch tray(const Vec3& middle, float side) {
  Patch patch;
  patch.width_m = side;
  patch.height_m = side;
  patch.density = 0.0f;
  patch.at = [=](float u, float v, float) {
    const auto across = [](float t) { return unit_clamp(2.0f * t - 0.5f) - 0.5f; };
    const auto depth = [](float t) { return unit_clamp(4.0f * std::min(t, 1.0f - t)); };
    const float y = kTrayDepth * std::min(1.0f, side) * std::min(depth(u), depth(v));
    return Surfel{middle + Vec3(side * across(u), y, side * across(v)), Vec3::Zero()};
  };
  turn_towards(patch, middle - Vec3::UnitY());
  return patch;
}

std::vector<Lamp> lamp_grid(int count) {
  const float side = std::sqrt(kLampArea / static_cast<float>(count));
  // Rows and columns in the proportions of the hall.
  const auto rows = static_cast<int>(std::ceil(std::sqrt(static_cast<float>(count) * kHalfLength / kHalfWidth)));
  const int per_row = (count + rows - 1) / rows;
  std::vector<Lamp> lamps;
  for (int i = 0; i < count; ++i) {
    const int row = i / per_row;
    const int in_this_row = std::min(per_row, count - row * per_row);
    const auto place = [](int k, int of) { return (static_cast<float>(k) + 0.5f) / static_cast<float>(of) - 0.5f; };
    lamps.push_back({.name = fmt::format("lamp {}", i + 1),
                     .kind = "rectangle",
                     .position = {2.0f * kHalfWidth * place(i % per_row, in_this_row), kLampHeight,
                                  2.0f * kHalfLength * place(row, (count + per_row - 1) / per_row)},
                     .side_m = side,
                     .luminance = Vec3(1.0f, 0.93f, 0.82f) * kLuminance});
  }
  return lamps;
}

}  // namespace

Result<Grotto> plan_interior(std::uint64_t triangles, std::uint32_t seed, int lamps) {
  TRY(check_triangles(triangles));
  if (lamps < 1 || lamps > kMaxInteriorLamps) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("{} lamps: an interior has 1 to {}", lamps, kMaxInteriorLamps));
  }
  Grotto hall;
  hall.kind = Kind::kInterior;
  hall.lamps = lamp_grid(lamps);
  std::vector<Patch> trays;
  for (const Lamp& lamp : hall.lamps) trays.push_back(tray(lamp.position, lamp.side_m));
  hall.parts = {{"walls.ply", walls(seed)},     {"floor_and_ceiling.ply", floor_and_ceiling(seed)},
                {"columns.ply", columns(seed)}, {"exhibits.ply", exhibits(seed)},
                {"benches.ply", benches(seed)}, {"lamp_trays.ply", std::move(trays)}};
  TRY(share_triangles(hall.parts, triangles));
  return hall;
}

}  // namespace cyclorama::generator

// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "renderfarm/generator/chamber.h"
#include "renderfarm/generator/motifs.h"
#include "renderfarm/generator/noise.h"
#include "renderfarm/generator/paint.h"

namespace cyclorama::generator {
namespace {

using namespace pigment;  // NOLINT(google-build-using-namespace): colours by name, in this file only.

constexpr float kValanceFrom = 3.78f;
constexpr float kBandFrom = 3.50f;
constexpr float kGridFrom = 0.86f;  ///< The thousand Buddhas begin at this height.
constexpr float kPetalsFrom = 0.60f;

/// Returns the distance to the outline of a niche, an arch on straight sides; negative inside.
float arch(const Niche& niche, const Vec2& p) {
  const float half = 0.5f * niche.width;
  const Vec2 q{p.x() - niche.centre, p.y() - niche.sill};
  const float springing = niche.height - half;
  if (q.y() > springing) return Vec2(q.x(), q.y() - springing).norm() - half;
  return std::max(std::abs(q.x()) - half, -q.y());
}

struct Nearest {
  const Niche* niche = nullptr;
  float distance = 10.0f;
};

Nearest nearest_niche(const WallFrame& frame, const Vec2& p) {
  Nearest nearest;
  for (const Niche& niche : frame.niches) {
    const float distance = arch(niche, p);
    if (distance < nearest.distance) nearest = {&niche, distance};
  }
  return nearest;
}

/// Returns the depth of a niche at `distance` from its outline: steep at the rim, flat at the back.
float recess(const Niche& niche, float distance) {
  const float t = unit_clamp(-distance / (0.30f * niche.width));
  return niche.depth * std::sqrt(1.0f - (1.0f - t) * (1.0f - t));
}

/// Returns the colour of a niche: bands that follow the arch, darker with depth.
Vec3 niche_colour(const Niche& niche, const Vec2& p, float distance, float spacing) {
  const std::array<Vec3, 6> bands = {kPaleGreen, kWhite, kRust, kPaleBlue, kOchre, kRust};
  const float step = 0.085f * niche.width;
  const auto [band, x] = repeat(-distance, step);
  Spot spot(bands[static_cast<std::size_t>(std::clamp(band, 0, 5))]);
  spot.lay(kWhite, line_coverage(std::abs(x) - 0.5f * step, 0.15f * step, spacing));
  const Vec2 q{p.x() - niche.centre, p.y() - niche.sill - 0.55f * niche.height};
  const float flames = std::sin(std::atan2(q.x(), q.y()) * 16.0f + q.norm() * 14.0f);
  if (band >= 1) spot.lay(kCinnabar, 0.35f * smooth_step(0.2f, 0.6f, flames));
  spot.darken(0.55f * smooth_step(0.0f, 0.9f, recess(niche, distance) / niche.depth));
  spot.darken(0.35f * smooth_step(0.25f, 0.0f, p.y() - niche.sill));
  return spot.colour();
}

/// Returns the signed distance to the outline of the door.
float door(const Vec2& p) { return box(p, {0.0f, 0.0f}, {kDoorHalfWidth, kDoorHeight}); }

/// Returns the colour of the wall's bands, from the floor to the cove.
Vec3 bands_colour(const Vec2& p, float spacing) {
  const float y = p.y();
  if (y > kValanceFrom)
    return valance({p.x(), std::min(y, kWallHeight) - kValanceFrom}, kWallHeight - kValanceFrom, spacing);
  if (y > kBandFrom) return scroll_band({p.x(), y - kBandFrom}, kValanceFrom - kBandFrom, spacing);
  if (y > kGridFrom) return thousand_buddhas({p.x(), y - kGridFrom}, spacing);
  if (y > kPetalsFrom) return petal_band({p.x(), y - kPetalsFrom}, kGridFrom - kPetalsFrom, spacing);
  // The dado: draped cloth over plain red earth.
  const float drape = 0.42f - 0.10f * std::abs(std::sin(kPi * p.x() / 0.9f));
  Spot spot(kRust * 0.8f);
  spot.lay(kOchre, coverage(drape - y, spacing));
  spot.lay(kPlaster * (0.85f + 0.15f * std::sin(p.x() * 34.0f)), coverage(drape + 0.03f - y, spacing));
  return spot.colour();
}

Vec3 face_colour(const WallFrame& frame, const Vec2& p, float spacing) {
  const Nearest near = nearest_niche(frame, p);
  if (near.niche != nullptr && near.distance < 0.0f) return niche_colour(*near.niche, p, near.distance, spacing);
  const float y = p.y();
  Spot spot(bands_colour(p, spacing));
  constexpr float kDoorFrame = 0.26f;
  if (frame.has_door && door(p) < kDoorFrame) {
    const float along = std::abs(p.x()) > kDoorHalfWidth ? y : p.x();
    spot.lay(scroll_band({along, std::max(0.0f, door(p))}, kDoorFrame, spacing),
             coverage(door(p) - kDoorFrame, spacing));
  }
  if (near.niche == nullptr) return spot.colour();
  // The painted frame of the niche.
  const float width = 0.07f + 0.05f * near.niche->width;
  const float beyond = near.distance - width;
  if (beyond > spacing || y < near.niche->sill - 0.02f) return spot.colour();
  const Vec2 q{p.x() - near.niche->centre, y - near.niche->sill - 0.5f * near.niche->height};
  const float along = std::atan2(q.x(), q.y()) * 0.5f * near.niche->width * 1.5f;
  spot.lay(scroll_band({along, near.distance}, width, spacing), coverage(beyond, spacing));
  return spot.colour();
}

/// Returns the distance to the nearest edge at which the face meets another face: corners, the cove, the door and the
/// line above its posts.
float to_edge(const WallFrame& frame, const Vec2& p, float half_width) {
  const float edge = std::min(half_width - std::abs(p.x()), kWallHeight - p.y());
  if (!frame.has_door) return edge;
  const float post = std::abs(p.x()) - kDoorHalfWidth;
  return std::min({edge, std::abs(post), post > 0.0f ? edge : std::abs(p.y() - kDoorHeight)});
}

/// Returns the distance of the face from its plane, positive into the room: rough rock under plaster, 0 at the edges.
float face_height(const WallFrame& frame, const Vec2& p, const Vec3& p3, const Age& age, float half_width,
                  std::uint32_t seed) {
  float height = 0.055f * fractal_noise(p3 * 0.55f, 3, seed + 101u) + 0.006f * noise(p3 * 5.0f, seed + 102u);
  height -= age.plaster_lost *
            (0.012f + 0.022f * chisel_marks(p, seed + 103u) + 0.012f * fractal_noise(p3 * 6.0f, 3, seed + 104u));
  height -= 0.012f * age.crack;
  const float edge = to_edge(frame, p, half_width);
  height *= smooth_step(0.0f, 0.25f, edge);
  // A rail under the cove.
  height +=
      0.05f * smooth_window(kWallHeight - 0.13f, kWallHeight - 0.03f, 0.015f, p.y()) * smooth_step(0.0f, 0.03f, edge);
  const Nearest near = nearest_niche(frame, p);
  if (near.niche == nullptr) return height;
  const float width = 0.07f + 0.05f * near.niche->width;
  if (p.y() > near.niche->sill - 0.02f) height += 0.035f * smooth_window(0.0f, width, 0.02f, near.distance);
  return height - recess(*near.niche, near.distance);
}

/// Returns the share of paint that is lost, which is greatest near the floor, through damp and visitors, and in
/// corners.
float loss_at(const Vec2& p, float half_width) {
  return 0.14f + 0.5f * smooth_step(0.7f, 0.0f, p.y()) + 0.30f * smooth_step(0.6f, 0.0f, half_width - std::abs(p.x()));
}

struct Extent {
  float left;
  float right;
  float bottom;
  float top;
};

/// Returns a part of a wall. Its rows are concentrated at viewing height: the fraction `rows_low` of them is below
/// `knee`.
Patch face(const WallFrame& frame, const Extent& extent, float knee, float rows_low, float half_width, float density,
           std::uint32_t seed) {
  Patch patch;
  patch.width_m = extent.right - extent.left;
  patch.height_m = (extent.top - knee) / (1.0f - rows_low);
  patch.density = density;
  patch.at = [=](float u, float v, float spacing) {
    const float y = v < rows_low ? mix(extent.bottom, knee, v / rows_low)
                                 : mix(knee, extent.top, (v - rows_low) / (1.0f - rows_low));
    const Vec2 p{mix(extent.left, extent.right, u), y};
    const Vec3 p3 = frame.origin + p.x() * frame.along + p.y() * Vec3::UnitY();
    const float loss = loss_at(p, half_width) * smooth_step(0.0f, 0.3f, nearest_niche(frame, p).distance);
    const Age age = age_of(p3, loss, seed);
    Spot spot(aged(face_colour(frame, p, spacing), age, p3, loss, seed));
    // Corners receive less light from the room.
    spot.darken(0.40f * smooth_step(0.35f, 0.0f, half_width - std::abs(p.x())));
    return Surfel{p3 + face_height(frame, p, p3, age, half_width, seed) * frame.inward, spot.colour()};
  };
  turn_towards(patch, Vec3(0.0f, 2.0f, 0.0f));
  return patch;
}

/// Returns the wall with the door: pieces to the left, to the right and above.
std::vector<Patch> entrance(const WallFrame& frame, std::uint32_t seed) {
  constexpr float kDensity = 0.38f;
  return {face(frame, {-kHalfLength, -kDoorHalfWidth, -0.2f, kWallHeight}, 0.8f, 0.15f, kHalfLength, kDensity, seed),
          face(frame, {kDoorHalfWidth, kHalfLength, -0.2f, kWallHeight}, 0.8f, 0.15f, kHalfLength, kDensity, seed),
          face(frame, {-kDoorHalfWidth, kDoorHalfWidth, kDoorHeight, kWallHeight}, kDoorHeight + 0.1f, 0.06f,
               kHalfLength, kDensity, seed)};
}

}  // namespace

Vec3 WallFrame::in_niche(std::size_t i, float forward) const {
  return origin + niches[i].centre * along + niches[i].sill * Vec3::UnitY() + forward * inward;
}

WallFrame wall_frame(Side side) {
  const auto small = [](float centre) { return Niche{centre, 2.28f, 0.95f, 1.15f, 0.42f}; };
  const auto large = [](float centre, float sill) { return Niche{centre, sill, 2.05f, 2.45f, 0.75f}; };
  switch (side) {
    case Side::kAltar:
      return {{0.0f, 0.0f, -kHalfDepth}, Vec3::UnitX(), Vec3::UnitZ(), {large(-7.35f, 0.85f), large(7.35f, 0.85f)}};
    case Side::kHead:
      return {
          {-kHalfLength, 0.0f, 0.0f}, -Vec3::UnitZ(), Vec3::UnitX(), {large(-1.1f, 0.75f), small(1.0f), small(2.45f)}};
    case Side::kFeet:
      return {
          {kHalfLength, 0.0f, 0.0f}, Vec3::UnitZ(), -Vec3::UnitX(), {large(1.1f, 0.75f), small(-1.0f), small(-2.45f)}};
    case Side::kEntrance:
      break;
  }
  return {{0.0f, 0.0f, kHalfDepth},
          -Vec3::UnitX(),
          -Vec3::UnitZ(),
          {large(-4.0f, 0.75f), large(4.0f, 0.75f), small(-6.6f), small(6.6f)},
          true};
}

std::vector<Patch> wall(Side side, std::uint32_t seed) {
  const WallFrame frame = wall_frame(side);
  switch (side) {
    case Side::kAltar:
      return {face(frame, {-kHalfLength, kHalfLength, kAltarHeight - 0.2f, kWallHeight}, 1.3f, 0.06f, kHalfLength, 1.0f,
                   seed)};
    case Side::kHead:
    case Side::kFeet:
      return {face(frame, {-kHalfDepth, kHalfDepth, -0.2f, kWallHeight}, 0.8f, 0.14f, kHalfDepth, 0.74f, seed)};
    case Side::kEntrance:
      break;
  }
  return entrance(frame, seed);
}

}  // namespace cyclorama::generator

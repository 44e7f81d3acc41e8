// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "renderfarm/generator/motifs.h"
#include "renderfarm/generator/paint.h"

namespace cyclorama::generator {
namespace {

using namespace pigment;  // NOLINT(google-build-using-namespace): colours by name, in this file only.

/// Returns the approximate signed distance to a ring of petals with tips at `tip` and notches at `notch`.
float petals_outline(float r, float angle, float notch, float tip, int petals, float turn) {
  const float wave = std::abs(std::cos(0.5f * (angle + turn) * static_cast<float>(petals)));
  return r - mix(notch, tip, std::pow(wave, 0.7f));
}

float square(const Vec2& p, float half) { return std::max(std::abs(p.x()), std::abs(p.y())) - half; }

Vec2 turned_45(const Vec2& p) { return Vec2(p.x() - p.y(), p.x() + p.y()) * std::numbers::sqrt2_v<float> * 0.5f; }

}  // namespace

Vec3 lotus(const Vec2& p, float radius, int petals, const Vec3& ground, float spacing) {
  const float r = p.norm();
  const float angle = std::atan2(p.y(), p.x());
  const float half_turn = kPi / static_cast<float>(petals);
  Spot spot(ground);
  spot.lay(kWhite, coverage(petals_outline(r, angle, 0.72f * radius, radius, petals, half_turn), spacing));
  spot.lay(kMalachite, coverage(petals_outline(r, angle, 0.66f * radius, 0.93f * radius, petals, half_turn), spacing));
  spot.lay(kWhite, coverage(petals_outline(r, angle, 0.54f * radius, 0.80f * radius, petals, 0.0f), spacing));
  spot.lay(kCinnabar, coverage(petals_outline(r, angle, 0.47f * radius, 0.73f * radius, petals, 0.0f), spacing));
  spot.lay(mix(kCinnabar, kWhite, 0.6f),
           coverage(petals_outline(r, angle, 0.38f * radius, 0.55f * radius, petals, 0.0f), spacing));
  spot.lay(kAzurite, coverage(r - 0.34f * radius, spacing));
  spot.lay(kGold, coverage(r - 0.27f * radius, spacing));
  const float seed_ring = std::abs(r - 0.16f * radius) - 0.02f * radius - 0.02f * radius * std::cos(8.0f * angle);
  spot.lay(kMalachite, coverage(seed_ring, spacing));
  return spot.colour();
}

Vec3 lantern(const Vec2& p, float half, float spacing) {
  Spot spot(kRust);
  const Vec2 d = turned_45(p);
  const std::array<float, 3> sides = {1.0f, 0.68f, 0.46f};
  const std::array<Vec3, 3> fields = {kAzurite, kMalachite, kIndigo};
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const float side = sides[i] * half;
    const Vec2& q = i % 2 == 0 ? p : d;
    const float outside = square(q, side);
    const float along = std::abs(q.x()) > std::abs(q.y()) ? q.y() : q.x();
    spot.lay(kOchre, coverage(outside, spacing));
    // The beam: a ribbon of lozenges.
    const float lozenge =
        std::abs(repeat(along, 0.16f * half).offset) + std::abs(outside + 0.055f * half) - 0.055f * half;
    spot.lay(kCinnabar, coverage(std::abs(outside + 0.055f * half) - 0.045f * half, spacing));
    spot.lay(kWhite, coverage(lozenge, spacing));
    spot.lay(fields[i], coverage(outside + 0.11f * half, spacing));
  }
  const Vec3 blossom = lotus(p, 0.34f * half, 8, kIndigo, spacing);
  spot.lay(blossom, coverage(p.norm() - 0.35f * half, spacing));
  // Corner blossoms in the outer triangles.
  const Vec2 corner = p.cwiseAbs() - Vec2::Constant(0.70f * half);
  const Vec3 bud = lotus(corner, 0.16f * half, 6, kAzurite, spacing);
  spot.lay(bud, coverage(corner.norm() - 0.17f * half, spacing));
  return spot.colour();
}

Vec3 nimbus(float r, float angle, float metres, int scheme, float spacing) {
  const std::array<std::array<Vec3, 5>, 3> schemes = {{
      {kPaleGreen, kCinnabar, kAzurite, kOchre, kMalachite},
      {kPaleBlue, kOchre, kMalachite, kCinnabar, kIndigo},
      {kOchre, kMalachite, kCinnabar, kPaleBlue, kRust},
  }};
  const auto& colours = schemes[static_cast<std::size_t>(cycle(scheme, 3))];
  Spot spot(kCinnabar);
  // Flames at the rim.
  const float flame = 0.90f + 0.10f * std::abs(std::sin(angle * 11.0f + 3.0f * r));
  spot.lay(kGold, coverage((r - flame) * metres, spacing));
  spot.lay(kCinnabar, coverage((r - flame + 0.05f) * metres, spacing));
  const auto disc = [&](float radius, const Vec3& colour) {
    spot.lay(colour, coverage((r - radius) * metres, spacing));
  };
  disc(0.84f, kWhite);
  disc(0.815f, colours[0]);
  // A ring of scroll.
  const float wave = r - 0.735f - 0.028f * std::sin(angle * 18.0f);
  spot.lay(kWhite, coverage((std::abs(wave) - 0.012f) * metres, spacing));
  disc(0.66f, kWhite);
  disc(0.64f, colours[1]);
  const float pearl = std::hypot(repeat(angle * 0.59f, 0.59f * kPi / 18.0f).offset, r - 0.59f) - 0.03f;
  spot.lay(kGold, coverage(pearl * metres, spacing));
  disc(0.54f, kWhite);
  disc(0.52f, colours[2]);
  const float rays = r - 0.30f - 0.18f * std::abs(std::sin(angle * 12.0f));
  spot.lay(mix(colours[2], kWhite, 0.45f), coverage(rays * metres, spacing));
  disc(0.30f, kGold);
  disc(0.27f, colours[4]);
  return spot.colour();
}

Vec3 floor_tile(const Vec2& p, float spacing, float* ret_relief) {
  constexpr float kTile = 0.40f;
  const auto [i, x] = repeat(p.x(), kTile);
  const auto [j, y] = repeat(p.y(), kTile);
  const Vec2 local{x, y};
  const float edge = square(local, 0.5f * kTile - 0.008f);
  const float r = local.norm();
  const float angle = std::atan2(y, x);
  const bool blossom = cycle(i + j, 2) == 0;
  const float petal = std::max(petals_outline(r, angle, 0.115f, 0.165f, 8, 0.0f), 0.055f - r);
  const float heart = r - 0.042f;
  const float carved = blossom ? coverage(std::min(petal, heart), std::max(spacing, 0.02f)) : 0.0f;
  const float inside = coverage(edge, std::max(spacing, 0.012f));
  *ret_relief = inside * (0.5f + 0.5f * carved);
  Spot spot(Vec3(0.30f, 0.26f, 0.22f));
  spot.lay(mix(Vec3(0.50f, 0.43f, 0.35f), Vec3(0.56f, 0.47f, 0.37f), blossom ? 0.0f : 1.0f), inside);
  spot.lay(Vec3(0.63f, 0.54f, 0.42f), carved * inside * 0.8f);
  return spot.colour();
}

}  // namespace cyclorama::generator

// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "renderfarm/generator/motifs.h"
#include "renderfarm/generator/paint.h"

namespace cyclorama::generator {
namespace {

using namespace pigment;  // NOLINT(google-build-using-namespace): colours by name, in this file only.

/// Paints a row of pearls on a dark ribbon along y = `at`.
void lay_pearls(const Vec2& p, float at, float width, float spacing, Spot& spot) {
  spot.lay(kRust, coverage(std::abs(p.y() - at) - 0.5f * width, spacing));
  const float x = repeat(p.x(), width * 1.25f).offset;
  spot.lay(kWhite, coverage(Vec2(x, p.y() - at).norm() - 0.36f * width, spacing));
}

}  // namespace

Vec3 scroll_band(const Vec2& p, float height, float spacing) {
  const float period = 2.6f * height;
  const float middle = 0.5f * height;
  const float phase = 2.0f * kPi * p.x() / period;
  const float stem = middle + 0.17f * height * std::sin(phase);
  Spot spot(kOchre);
  spot.lay(kMalachite, coverage(std::abs(p.y() - stem) - 0.035f * height, spacing));
  const auto [i, x] = repeat(p.x(), 0.5f * period);
  const float side = cycle(i, 2) == 0 ? 1.0f : -1.0f;
  const Vec2 local{x, (p.y() - middle) * side};
  // A blossom in each bend, with leaves curling around it.
  const Vec2 heart{0.0f, -0.10f * height};
  const Vec2 q = local - heart;
  const float r = q.norm();
  const float leaf_angle = std::atan2(q.y(), q.x());
  spot.lay(kAzurite,
           coverage(std::abs(r - 0.27f * height) - (0.05f + 0.03f * std::sin(5.0f * leaf_angle)) * height, spacing) *
               smooth_step(-0.9f, -0.4f, -std::sin(leaf_angle)));
  spot.lay(kWhite, coverage(r - (0.17f + 0.035f * std::cos(6.0f * leaf_angle)) * height, spacing));
  spot.lay(kCinnabar, coverage(r - (0.13f + 0.03f * std::cos(6.0f * leaf_angle)) * height, spacing));
  spot.lay(kGold, coverage(r - 0.05f * height, spacing));
  lay_pearls(p, 0.06f * height, 0.13f * height, spacing, spot);
  lay_pearls(p, 0.94f * height, 0.13f * height, spacing, spot);
  return spot.colour();
}

Vec3 petal_band(const Vec2& p, float height, float spacing) {
  const std::array<Vec3, 4> colours = {kCinnabar, kMalachite, kOchre, kAzurite};
  const float width = 0.8f * height;
  Spot spot(kRust);
  for (int layer = 0; layer < 2; ++layer) {
    const auto [i, x] = repeat(p.x() + 0.5f * width * static_cast<float>(layer), width);
    const float y = unit_clamp(p.y() / height);
    const float half = 0.47f * width * std::sqrt(std::max(0.0f, 1.0f - y * y)) * (1.0f - 0.25f * y);
    const Vec3& colour = colours[static_cast<std::size_t>(cycle(i + 2 * layer, 4))];
    spot.lay(kWhite, coverage(std::abs(x) - half, spacing));
    spot.lay(colour, coverage(std::abs(x) - 0.80f * half, spacing));
    spot.lay(mix(colour, kWhite, 0.55f), coverage(std::abs(x) - 0.34f * half, spacing));
  }
  lay_pearls(p, 0.97f * height, 0.12f * height, spacing, spot);
  return spot.colour();
}

Vec3 valance(const Vec2& p, float height, float spacing) {
  const std::array<Vec3, 4> flags = {kCinnabar, kMalachite, kAzurite, kOchre};
  const float drop = height - p.y();  // Distance down from the rail.
  const float width = 0.95f * height;
  Spot spot(mix(kRust, kInk, 0.3f));
  // Pleated cloth behind.
  const float pleat = 0.5f + 0.5f * std::sin(2.0f * kPi * p.x() / (0.16f * height));
  const float hem = height * (0.86f + 0.05f * std::sin(2.0f * kPi * p.x() / (0.5f * width)));
  spot.lay(mix(kPaleGreen, kMalachite, pleat), coverage(drop - hem, spacing));
  for (int layer = 0; layer < 2; ++layer) {
    const auto [i, x] = repeat(p.x() + 0.5f * width * static_cast<float>(layer), width);
    const float length = (layer == 0 ? 0.62f : 0.78f) * height;
    const float half = 0.5f * width * (1.0f - drop / length);
    const float inside = std::abs(x) - half;
    const Vec3& colour = flags[static_cast<std::size_t>(cycle(i * 2 + layer, 4))];
    spot.lay(kWhite, coverage(inside, spacing));
    spot.lay(colour, coverage(inside + 0.07f * width, spacing));
    spot.lay(kGold, coverage(Vec2(x, drop - 0.24f * height).norm() - 0.06f * height, spacing));
    spot.lay(kCinnabar, coverage(Vec2(x, drop - length - 0.02f * height).norm() - 0.045f * height, spacing));
  }
  lay_pearls(p, 0.93f * height, 0.14f * height, spacing, spot);
  return spot.colour();
}

Vec3 brocade(const Vec2& p, const Vec3& ground, const Vec3& figure, float spacing) {
  constexpr float kPeriod = 0.24f;
  const auto [row, y] = repeat(p.y(), kPeriod);
  const auto [column, x] = repeat(p.x() + (cycle(row, 2) == 0 ? 0.0f : 0.5f * kPeriod), kPeriod);
  const float r = std::hypot(x, y);
  const float angle = std::atan2(y, x);
  Spot spot(ground);
  spot.lay(figure, coverage(r - 0.088f, spacing));
  spot.lay(mix(ground, kInk, 0.25f), coverage(r - 0.072f, spacing));
  spot.lay(figure, coverage(r - 0.045f - 0.014f * std::cos(6.0f * angle), spacing));
  spot.lay(cycle(column, 2) == 0 ? kCinnabar : kAzurite, coverage(r - 0.018f, spacing));
  return spot.colour();
}

}  // namespace cyclorama::generator

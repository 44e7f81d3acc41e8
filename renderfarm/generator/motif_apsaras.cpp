// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <span>

#include "renderfarm/generator/motifs.h"
#include "renderfarm/generator/noise.h"
#include "renderfarm/generator/paint.h"

namespace cyclorama::generator {
namespace {

using namespace pigment;  // NOLINT(google-build-using-namespace): colours by name, in this file only.

struct Stroke {
  Vec2 from;
  float from_radius;
  Vec2 to;
  float to_radius;
};

/// Size of a figure, whose box is 2.6 wide and 1.2 high. The figure flies to the left, with the legs trailing.
constexpr float kReach = 1.25f;

float nearest(const Vec2& p, std::span<const Stroke> strokes) {
  float distance = 10.0f;
  for (const Stroke& s : strokes) distance = std::min(distance, stroke(p, s.from, s.from_radius, s.to, s.to_radius));
  return distance;
}

void lay_ribbons(const Vec2& p, const Vec3& first, const Vec3& second, float spacing, Spot& spot) {
  for (int i = 0; i < 3; ++i) {
    const float k = static_cast<float>(i);
    const float along = p.x() + 0.55f;
    // Ribbons start at the shoulders and swing wider the farther they trail.
    const float swing = 0.05f + 0.10f * std::max(along, 0.0f);
    const float y = 0.20f + 0.10f * k + 0.10f * along + swing * std::sin(4.2f * along + 1.7f * k);
    const float width = 0.030f * smooth_step(-0.05f, 0.3f, along) * smooth_step(1.75f, 1.1f, along);
    const float inside = std::abs(p.y() - y) - width;
    if (width <= 0.0f) continue;
    spot.lay(kWhite, coverage(inside - 0.012f, spacing));
    spot.lay(i == 1 ? second : first, coverage(inside, spacing));
  }
}

void lay_apsara(const Vec2& p, int scheme, float spacing, Spot& spot) {
  const std::array<std::array<Vec3, 3>, 4> schemes = {{
      {kCinnabar, kMalachite, kOchre},
      {kMalachite, kCinnabar, kPaleBlue},
      {kRust, kAzurite, kPaleGreen},
      {kAzurite, kOchre, kCinnabar},
  }};
  const auto& colours = schemes[static_cast<std::size_t>(cycle(scheme, 4))];
  lay_ribbons(p, colours[1], colours[2], spacing, spot);
  const std::array<Stroke, 4> skirt = {{{{-0.22f, -0.06f}, 0.10f, {0.05f, -0.20f}, 0.13f},
                                        {{0.05f, -0.20f}, 0.13f, {0.38f, -0.10f}, 0.11f},
                                        {{0.38f, -0.10f}, 0.11f, {0.80f, 0.10f}, 0.06f},
                                        {{0.30f, -0.14f}, 0.09f, {0.72f, -0.10f}, 0.04f}}};
  const std::array<Stroke, 6> skin = {{{{-0.24f, -0.03f}, 0.075f, {-0.40f, 0.14f}, 0.085f},
                                       {{-0.42f, 0.17f}, 0.035f, {-0.66f, 0.06f}, 0.03f},
                                       {{-0.66f, 0.06f}, 0.03f, {-0.86f, 0.16f}, 0.025f},
                                       {{-0.38f, 0.18f}, 0.035f, {-0.20f, 0.34f}, 0.03f},
                                       {{-0.20f, 0.34f}, 0.03f, {-0.32f, 0.50f}, 0.025f},
                                       {{0.80f, 0.10f}, 0.035f, {0.92f, 0.14f}, 0.02f}}};
  const float skirt_distance = nearest(p, skirt);
  spot.lay(kInk, coverage(skirt_distance - 0.014f, spacing) * 0.7f);
  spot.lay(colours[0], coverage(skirt_distance, spacing));
  spot.lay(mix(colours[0], kWhite, 0.5f), line_coverage(skirt_distance + 0.05f, 0.02f, spacing));
  const float skin_distance = nearest(p, skin);
  spot.lay(kInk, coverage(skin_distance - 0.012f, spacing) * 0.6f);
  spot.lay(kFlesh, coverage(skin_distance, spacing));
  const Vec2 head{-0.50f, 0.30f};
  spot.lay(kWhite, coverage((p - head).norm() - 0.155f, spacing));
  spot.lay(colours[1], coverage((p - head).norm() - 0.135f, spacing));
  spot.lay(kInk, coverage(ellipse(p, head + Vec2(0.01f, 0.035f), {0.066f, 0.075f}), spacing));
  spot.lay(kFlesh, coverage(ellipse(p, head, {0.055f, 0.065f}), spacing));
}

}  // namespace

Vec3 flying_apsaras(const Vec2& p, float height, float spacing) {
  const auto [i, x] = repeat(p.x(), kApsaraWidth);
  const float y = p.y() - 0.5f * height;
  Spot spot(mix(kPaleBlue, kPlaster, smooth_step(-0.5f * height, 0.5f * height, y) * 0.8f));
  // Cloud scrolls: contour lines of a low-frequency noise.
  const float cloud = noise({p.x() * 1.6f, p.y() * 2.6f, 3.0f}, 77u);
  spot.lay(kWhite, smooth_step(0.12f, 0.2f, cloud) * 0.8f);
  spot.lay(kMalachite, line_coverage((cloud - 0.12f) * 0.5f, 0.03f, spacing) * 0.8f);
  spot.lay(kCinnabar, line_coverage((cloud - 0.3f) * 0.5f, 0.02f, spacing) * 0.6f);
  const float scale = kReach * 0.78f;
  const float nod = 0.12f * std::sin(2.4f * static_cast<float>(i));
  lay_apsara(Vec2(x, y + nod * height * 0.4f) / scale, i, spacing / scale, spot);
  return spot.colour();
}

}  // namespace cyclorama::generator

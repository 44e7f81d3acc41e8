// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/generator/furnishings.h"

#include <array>

#include "renderfarm/generator/chamber.h"
#include "renderfarm/generator/sculpture.h"
#include "renderfarm/generator/solid.h"

namespace cyclorama::generator {
namespace {

const Vec3 kBrass{0.62f, 0.47f, 0.22f};
const Vec3 kFlame{1.0f, 0.86f, 0.52f};
const Vec3 kWarm{1.0f, 0.62f, 0.30f};
constexpr float kLedge = kAltarFront + 0.04f;
constexpr std::array<float, 3> kGroups = {-5.6f, -0.6f, 3.6f};
constexpr std::array<float, 3> kInGroup = {-0.24f, 0.0f, 0.24f};
constexpr float kStandHeight = 1.02f;
const std::array<Vec3, 2> kStands = {Vec3(-6.7f, 0.0f, 0.05f), Vec3(6.7f, 0.0f, 0.05f)};

/// Returns a bowl on a foot with a flame, as a solid of revolution; `stem` is the height of the bowl.
Patch lamp_body(const Vec3& position, float stem, float scale) {
  Sculpture s;
  s.distance = [stem](const Vec3& p) {
    const float girth = stem > 0.0f ? 0.10f : 0.05f;
    float d = ellipsoid(p, {0.0f, 0.012f, 0.0f}, {girth, 0.018f, girth});
    d = blend(d, limb(p, {0.0f, 0.0f, 0.0f}, 0.016f, {0.0f, stem + 0.07f, 0.0f}, 0.013f), 0.03f);
    d = blend(d, ellipsoid(p, {0.0f, stem + 0.075f, 0.0f}, {0.066f, 0.026f, 0.066f}), 0.02f);
    return std::min(d, limb(p, {0.0f, stem + 0.115f, 0.0f}, 0.017f, {0.0f, stem + 0.175f, 0.0f}, 0.003f));
  };
  s.colour = [stem](const Vec3& p, float) { return p.y() > stem + 0.099f ? kFlame : kBrass; };
  s.from = {0.0f, 0.01f, 0.0f};
  s.to = {0.0f, stem + 0.17f, 0.0f};
  s.reach = 0.12f;
  s.girth = 0.30f;
  return wrapped(s, standing_at(position, 0.0f, scale), 0.9f);
}

}  // namespace

std::vector<Patch> lamp_bodies() {
  std::vector<Patch> patches;
  for (const float group : kGroups) {
    for (const float beside : kInGroup)
      patches.push_back(lamp_body({group + beside, kAltarHeight, kLedge}, 0.0f, 1.0f));
  }
  for (const Vec3& stand : kStands) patches.push_back(lamp_body(stand, kStandHeight / 1.8f, 1.8f));
  return patches;
}

std::vector<Lamp> lamp_lights() {
  std::vector<Lamp> lamps;
  // The light of each group is a hand's breadth above the flames, because a flame would enclose a light inside it.
  for (std::size_t i = 0; i < kGroups.size(); ++i) {
    lamps.push_back({.name = "butter lamps " + std::to_string(i + 1),
                     .kind = "point",
                     .position = {kGroups[i], kAltarHeight + 0.36f, kLedge + 0.08f},
                     .intensity_cd = 0.7f * kWarm,
                     .radius_m = 0.06f});
  }
  for (std::size_t i = 0; i < kStands.size(); ++i) {
    lamps.push_back({.name = "lamp stand " + std::to_string(i + 1),
                     .kind = "point",
                     .position = kStands[i] + Vec3(0.0f, kStandHeight + 0.50f, 0.0f),
                     .intensity_cd = 5.0f * kWarm,
                     .radius_m = 0.08f});
  }
  lamps.push_back({.name = "daylight",
                   .kind = "point",
                   .position = {0.0f, 1.9f, 5.7f},
                   .intensity_cd = {34.0f, 42.0f, 50.0f},
                   .radius_m = 0.45f});
  lamps.push_back({.name = "light under the ceiling",
                   .kind = "point",
                   .position = {0.6f, 5.3f, 2.3f},
                   .intensity_cd = {50.0f, 42.0f, 32.0f},
                   .radius_m = 0.30f});
  lamps.push_back({.name = "light on the face",
                   .kind = "spot",
                   .position = {-1.6f, 4.9f, 2.4f},
                   .direction = (Vec3(-4.3f, 1.9f, -2.0f) - Vec3(-1.6f, 4.9f, 2.4f)).normalized(),
                   .intensity_cd = {46.0f, 36.0f, 24.0f},
                   .radius_m = 0.12f,
                   .inner_cone_deg = 8.0f,
                   .outer_cone_deg = 22.0f});
  return lamps;
}

}  // namespace cyclorama::generator

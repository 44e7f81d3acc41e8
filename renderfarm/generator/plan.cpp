// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "renderfarm/generator/chamber.h"
#include "renderfarm/generator/figures.h"
#include "renderfarm/generator/grotto.h"
#include "renderfarm/generator/noise.h"

namespace cyclorama::generator {
namespace {

constexpr float kFigureDensity = 0.75f;

void append(std::vector<Patch>&& from, std::vector<Patch>& to) {
  for (Patch& patch : from) to.push_back(std::move(patch));
}

/// Returns a seated figure for every niche, as large as the niche allows.
std::vector<Patch> niche_figures(std::uint32_t seed) {
  std::vector<Patch> patches;
  std::uint32_t variety = hash(1, 2, 3, seed) % 60u;
  for (const Side side : {Side::kAltar, Side::kHead, Side::kFeet, Side::kEntrance}) {
    const WallFrame frame = wall_frame(side);
    for (std::size_t i = 0; i < frame.niches.size(); ++i) {
      const Niche& niche = frame.niches[i];
      const float scale = 0.66f * niche.height;
      const Vec3 seat = frame.in_niche(i, -0.34f * niche.depth) + 0.22f * scale * Vec3::UnitY();
      const float heading = std::atan2(frame.inward.x(), frame.inward.z());
      const float density = side == Side::kAltar ? kFigureDensity : 0.55f * kFigureDensity;
      append(seated_buddha(standing_at(seat, heading, scale), variety++, density), patches);
    }
  }
  return patches;
}

/// Returns the disciples, who stand behind the reclining figure where they remain visible and face its head.
std::vector<Patch> disciples(std::uint32_t seed) {
  std::vector<Patch> patches;
  constexpr int kCount = 10;
  for (int i = 0; i < kCount; ++i) {
    const auto jitter = [&](int what) { return random_unit(i, what, seed + 201u) - 0.5f; };
    const float x = -0.55f + 0.62f * static_cast<float>(i) + 0.16f * jitter(1);
    const bool behind = i % 2 == 0;
    const float height = (behind ? 2.85f : 2.50f) + 0.18f * jitter(3);
    const Pose pose = standing_at({x, kAltarHeight, behind ? -3.28f : -3.02f}, -0.35f + 0.5f * jitter(2), height);
    append(mourning_disciple(pose, static_cast<std::uint32_t>(i) + seed % 6u, 0.85f * kFigureDensity), patches);
  }
  return patches;
}

}  // namespace

GeometryCounts Grotto::counts() const {
  GeometryCounts sum;
  for (const Part& part : parts) {
    const GeometryCounts counts = part.counts();
    sum.vertices += counts.vertices;
    sum.triangles += counts.triangles;
  }
  return sum;
}

Status check_triangles(std::uint64_t triangles) {
  if (triangles < kMinTriangles || triangles > kMaxTriangles) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("{} triangles: a grotto has {} to {}", triangles, kMinTriangles, kMaxTriangles));
  }
  return Done{};
}

Result<Grotto> plan_grotto(std::uint64_t triangles, std::uint32_t seed) {
  TRY(check_triangles(triangles));
  Pose bed;
  bed.position = {0.0f, kAltarHeight, -2.20f};
  Grotto grotto;
  grotto.parts = {{"altar_wall.ply", wall(Side::kAltar, seed)},
                  {"head_wall.ply", wall(Side::kHead, seed)},
                  {"feet_wall.ply", wall(Side::kFeet, seed)},
                  {"entrance_wall.ply", wall(Side::kEntrance, seed)},
                  {"ceiling.ply", ceiling(seed)},
                  {"floor.ply", floor_and_corridor(seed)},
                  {"altar.ply", altar(seed)},
                  {"reclining_buddha.ply", reclining_buddha(bed, kFigureDensity)},
                  {"seated_buddhas.ply", niche_figures(seed)},
                  {"disciples.ply", disciples(seed)},
                  {"lamps.ply", lamp_bodies()}};
  grotto.lamps = lamp_lights();
  TRY(share_triangles(grotto.parts, triangles));
  return grotto;
}

}  // namespace cyclorama::generator

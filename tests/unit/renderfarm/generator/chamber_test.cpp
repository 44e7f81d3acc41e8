// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/generator/chamber.h"

#include <gtest/gtest.h>

namespace cyclorama::generator {
namespace {

/// Share of a patch's area whose front faces `eye`.
double share_facing(Patch patch, const Vec3& eye) {
  constexpr int kSteps = 60;
  const auto at = [&](int i, int j) {
    return patch.at(static_cast<float>(i) / kSteps, static_cast<float>(j) / kSteps, 0.1f).position;
  };
  double towards = 0.0;
  double all = 0.0;
  for (int j = 0; j < kSteps; ++j) {
    for (int i = 0; i < kSteps; ++i) {
      const Vec3 a = at(i, j);
      const Vec3 normal = (at(i + 1, j) - a).cross(at(i, j + 1) - a) * (patch.flipped ? -1.0f : 1.0f);
      all += static_cast<double>(normal.norm());
      if (normal.dot(eye - a) > 0.0f) towards += static_cast<double>(normal.norm());
    }
  }
  return towards / all;
}

TEST(Chamber, walls_and_ceiling_face_inwards) {
  const Vec3 middle{0.0f, 2.2f, 1.0f};
  for (const std::uint32_t seed : {0u, 7u}) {
    for (const Side side : {Side::kAltar, Side::kHead, Side::kFeet, Side::kEntrance}) {
      for (const Patch& patch : wall(side, seed))
        EXPECT_GT(share_facing(patch, middle), 0.85) << static_cast<int>(side);
    }
    for (const Patch& patch : ceiling(seed)) EXPECT_GT(share_facing(patch, middle), 0.85);
  }
}

TEST(Chamber, floor_corridor_and_altar_face_the_visitor) {
  for (const Patch& patch : floor_and_corridor(3)) EXPECT_GT(share_facing(patch, {0.0f, 1.5f, 5.0f}), 0.85);
  for (const Patch& patch : altar(3)) EXPECT_GT(share_facing(patch, {0.0f, 3.0f, 2.0f}), 0.7);
}

TEST(Chamber, a_niche_is_a_hollow_that_holds_a_figure) {
  for (const Side side : {Side::kAltar, Side::kHead, Side::kFeet, Side::kEntrance}) {
    const WallFrame frame = wall_frame(side);
    ASSERT_FALSE(frame.niches.empty());
    for (std::size_t i = 0; i < frame.niches.size(); ++i) {
      const Niche& niche = frame.niches[i];
      EXPECT_GT(niche.sill + niche.height, niche.sill + 0.5f * niche.width);
      EXPECT_LT(niche.sill + niche.height, kWallHeight);
      const Vec3 sill = frame.in_niche(i, -niche.depth);
      EXPECT_NEAR((sill - frame.origin).dot(frame.inward), -niche.depth, 1e-5f);
      EXPECT_NEAR(sill.y(), niche.sill, 1e-5f);
    }
  }
}

}  // namespace
}  // namespace cyclorama::generator

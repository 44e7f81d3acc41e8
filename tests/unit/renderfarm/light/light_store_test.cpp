// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light/light_store.h"

#include <gtest/gtest.h>

#include <set>

namespace cyclorama::light {
namespace {

using Eigen::Vector3f;

std::uint32_t grey(float value) { return to_rgb9e5(Vector3f::Constant(value)); }

/// A mesh of one triangle with the light 1, 2 and 4 at its corners.
LightStore one_triangle() {
  LightStore store;
  store.surfaces.resize(1);
  store.surfaces[0].sides[0].base = {grey(1.0f), grey(2.0f), grey(4.0f)};
  return store;
}

constexpr std::array<std::uint32_t, 3> kCorners = {0, 1, 2};

TEST(LightStore, interpolates_between_the_corners_in_its_unit) {
  LightStore store = one_triangle();
  store.unit = 10.0f;
  EXPECT_EQ(store.at({0, 0, 0, kCorners, {1, 0, 0}})->x(), 10.0f);
  EXPECT_EQ(store.at({0, 0, 0, kCorners, {0, 0.5f, 0.5f}})->x(), 30.0f);
}

TEST(LightStore, has_no_light_on_a_side_that_nobody_sees) {
  EXPECT_FALSE(one_triangle().at({0, 1, 0, kCorners, {1, 0, 0}}));
}

TEST(LightStore, has_no_light_beside_a_missing_sample) {
  LightStore store = one_triangle();
  store.surfaces[0].sides[0].base[1] = kNoSample;
  EXPECT_FALSE(store.at({0, 0, 0, kCorners, {0.4f, 0.3f, 0.3f}}));
}

TEST(LightStore, reads_one_sample_for_a_whole_triangle_of_a_flat_mesh) {
  LightStore store = one_triangle();
  store.surfaces[0].base_per_triangle = true;
  for (const Vector3f& weights : {Vector3f(1, 0, 0), Vector3f(0.2f, 0.3f, 0.5f)}) {
    EXPECT_EQ(store.at({0, 0, 2, kCorners, weights})->x(), 4.0f);
  }
}

TEST(LightStore, traces_triangles_that_are_marked) {
  LightStore store = one_triangle();
  store.surfaces[0].sides[0].grids = {TriangleGrid::kTraced};
  EXPECT_FALSE(store.at({0, 0, 0, kCorners, {1, 0, 0}}));
}

TEST(TriangleGrid, numbers_every_sample_once) {
  for (const int parts : {1, 2, 4, 32}) {
    std::set<int> indices;
    for (int j = 0; j <= parts; ++j) {
      for (int i = 0; i + j <= parts; ++i) indices.insert(TriangleGrid::index(parts, i, j));
    }
    EXPECT_EQ(static_cast<int>(indices.size()), TriangleGrid::samples(parts));
    EXPECT_EQ(*indices.begin(), 0);
    EXPECT_EQ(*indices.rbegin(), TriangleGrid::samples(parts) - 1);
  }
}

TEST(TriangleGrid, codes_parts_and_offset) {
  for (int parts = 1; parts <= TriangleGrid::kMaxParts; parts *= 2) {
    const std::uint32_t code = TriangleGrid::code(parts, TriangleGrid::kMaxOffset - 1);
    EXPECT_EQ(TriangleGrid::parts(code), parts);
    EXPECT_EQ(TriangleGrid::offset(code), TriangleGrid::kMaxOffset - 1);
  }
}

TEST(TriangleGrid, is_linear_inside_each_part_and_continuous) {
  // Samples of a linear function give that function, in whichever part the point lies.
  constexpr int kParts = 4;
  LightStore store = one_triangle();
  SideLight& side = store.surfaces[0].sides[0];
  side.grids = {TriangleGrid::code(kParts, 0)};
  side.samples.resize(static_cast<std::size_t>(TriangleGrid::samples(kParts)));
  for (int j = 0; j <= kParts; ++j) {
    for (int i = 0; i + j <= kParts; ++i) {
      side.samples[static_cast<std::size_t>(TriangleGrid::index(kParts, i, j))] =
          grey(static_cast<float>(16 + 4 * i + 8 * j));
    }
  }
  for (int a = 0; a <= 40; ++a) {
    for (int b = 0; a + b <= 40; ++b) {
      const float u = static_cast<float>(a) / 40.0f;
      const float v = static_cast<float>(b) / 40.0f;
      const auto light = store.at({0, 0, 0, kCorners, {1.0f - u - v, u, v}});
      ASSERT_TRUE(light) << u << ' ' << v;
      EXPECT_NEAR(light->x(), 16.0f + 16.0f * u + 32.0f * v, 1e-3f) << u << ' ' << v;
    }
  }
}

}  // namespace
}  // namespace cyclorama::light

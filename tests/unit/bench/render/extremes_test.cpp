// SPDX-License-Identifier: Apache-2.0
/// A reduced version of the sweep of `cyclorama-bench-render extremes`, all of whose cases must hold here too.
#include <gtest/gtest.h>

#include <limits>

#include "tests/bench/render/extremes/extreme_shapes.h"
#include "tests/bench/render/extremes/picture_case.h"
#include "tests/bench/render/extremes/ray_sweep.h"
#include "tests/bench/render/extremes/same_picture.h"

namespace cyclorama::render {
namespace {

void expect_all_hold(const std::vector<PictureCase>& cases) {
  for (const PictureCase& extreme : cases) {
    SCOPED_TRACE(extreme.name);
    const Result<PictureVerdict> verdict = judge(extreme, testing::TempDir(), 2);
    ASSERT_TRUE(verdict.has_value()) << verdict.error().message();
    EXPECT_EQ(verdict->broken_samples, 0u);
    EXPECT_EQ(verdict->not_finite, 0);
    EXPECT_EQ(verdict->black, 0);
    EXPECT_EQ(verdict->pixels, 64 * 32);
  }
}

TEST(Extremes, no_surface_and_no_position_of_the_eye_gives_black_or_nan) { expect_all_hold(surface_cases()); }

TEST(Extremes, no_light_and_no_exposure_gives_black_or_nan) { expect_all_hold(light_cases()); }

TEST(Extremes, black_pixels_and_nan_are_detected) {
  const auto verdict_of = [](float albedo) {
    const PictureCase dark{"dark", [albedo](const std::filesystem::path&) -> Result<ExtremePicture> {
                             ExtremePicture picture{open_ground(), view_around({0.0, 1.0, 2.0})};
                             picture.scene.sky = scene::Sky{};
                             picture.scene.ambient.setConstant(albedo);
                             return picture;
                           }};
    return judge(dark, testing::TempDir(), 1);
  };
  EXPECT_GT(verdict_of(0.1f)->black, 0) << "the sky";
  EXPECT_GT(verdict_of(std::numeric_limits<float>::quiet_NaN())->broken_samples, 0u);
}

TEST(Extremes, far_from_the_origin_the_picture_is_the_same) {
  const auto pictures = far_from_the_origin({1e3, 1e6, 1e8}, 64, 2);
  ASSERT_TRUE(pictures.has_value());
  for (const SamePicture& picture : *pictures) EXPECT_LE(picture.flip, kSameFlip) << picture.metres << " m";
}

TEST(Extremes, from_millimetres_to_kilometres_the_picture_is_the_same) {
  const auto pictures = scaled({6e-3, 6e3}, 64, 2);
  ASSERT_TRUE(pictures.has_value());
  for (const SamePicture& picture : *pictures) EXPECT_LE(picture.flip, kSameFlip) << picture.metres << " m";
}

TEST(Extremes, a_closed_sphere_far_from_the_frames_origin_does_not_leak) {
  constexpr int kRays = 50'000;
  const auto leaks = count_leaks({148376.0, 1234.0, -223423.0}, kRays);
  ASSERT_TRUE(leaks.has_value());
  EXPECT_LE(static_cast<double>(leaks->leaks), kMaxLeakFraction * kRays);
  EXPECT_EQ(leaks->self_hits, 0u);
}

TEST(Extremes, rays_do_not_hit_the_triangle_from_which_they_start) {
  for (const double coordinate : {1.0, 1e3, 1e6, 1e8}) {
    const auto hits = count_self_hits(coordinate, 20'000);
    ASSERT_TRUE(hits.has_value());
    EXPECT_EQ(hits->self_hits, 0u) << coordinate;
    EXPECT_GT(hits->rays, 2000u) << coordinate;
  }
  // The fixed near distance, for comparison, does fail, so failures would be detected.
  EXPECT_GT(count_self_hits(1e3, 20'000)->self_hits_fixed_near, 100u);
}

}  // namespace
}  // namespace cyclorama::render

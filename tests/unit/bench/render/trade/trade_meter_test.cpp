// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/trade/trade_meter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/data_sets/simple_scenes.h"

namespace cyclorama::render {
namespace {

/// A closed sphere with a soft shadow inside: the light is noisy but has a finite variance.
class TradeMeterTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scene::Scene scene = scene_of(sphere_mesh(3.0f, 16));
    add_mesh(scene, sphere_mesh(0.4f, 8), Eigen::Affine3d(Eigen::Translation3d(0, 0, -1.5)));
    scene::Light light = point_light({0.5, 1.0, 0.0}, 2.0f);
    light.radius_m = 0.3f;
    scene.model.lights.push_back(light);
    auto built = Renderer::build(std::move(scene), 1, nullptr);
    ASSERT_TRUE(built) << built.error().message();
    renderer_ = std::move(*built);
    auto film = converged_film(
        *renderer_, view(128, 99), [](double) {}, nullptr);
    ASSERT_TRUE(film) << film.error().message();
    reference_ = std::move(*film);
  }
  static void TearDownTestSuite() { renderer_.reset(); }

  static PanoramaView view(int samples = 1, std::uint64_t seed = 0) {
    PanoramaView view = view_from({0, 0, 0}, 32, 16, 0.7, -0.7);
    view.quality.samples = samples;
    view.quality.bounces = trade_base().render.bounces;
    view.seed = seed;
    return view;
  }
  static TradePoint measured(const PictureQuality& quality) {
    TradeMeter meter(*renderer_, view(), reference_.mean());
    const auto point = meter.measure({"test", quality}, nullptr);
    EXPECT_TRUE(point) << point.error().message();
    return *point;
  }
  static PictureQuality samples(int count) {
    PictureQuality quality = trade_base();
    quality.render.samples = count;
    return quality;
  }
  static inline std::unique_ptr<Renderer> renderer_;
  static inline Film reference_;
};

TEST_F(TradeMeterTest, the_error_falls_and_rays_increase_with_the_samples) {
  const TradePoint few = measured(samples(1));
  const TradePoint many = measured(samples(32));
  EXPECT_LT(many.relmse, 0.1 * few.relmse);
  EXPECT_LT(many.shown.flip, few.shown.flip);
  EXPECT_GT(many.shown.ssim, few.shown.ssim);
  EXPECT_GT(many.rays, 20 * few.rays);
  EXPECT_GT(few.cpu_s, 0.0);
  EXPECT_GT(few.wall_s, 0.0);
}

TEST_F(TradeMeterTest, a_smaller_picture_has_fewer_rays_and_is_blurred) {
  PictureQuality small = samples(32);
  small.scale = 0.5;
  const TradePoint half = measured(small);
  const TradePoint full = measured(samples(32));
  EXPECT_LT(half.rays, full.rays / 3);
  EXPECT_LT(half.bytes, full.bytes);
  EXPECT_GT(half.shown.flip, full.shown.flip);
}

TEST_F(TradeMeterTest, the_denoiser_removes_noise_and_traces_no_more_rays) {
  PictureQuality denoised = samples(1);
  denoised.denoise = true;
  const TradePoint smooth = measured(denoised);
  const TradePoint noisy = measured(samples(1));
  EXPECT_LT(smooth.relmse, 0.5 * noisy.relmse);
  EXPECT_EQ(smooth.rays, noisy.rays);
}

TEST_F(TradeMeterTest, coding_changes_bytes_and_the_decoded_picture_but_no_ray) {
  TradeMeter meter(*renderer_, view(), reference_.mean());
  PictureQuality rough = samples(16);
  rough.jpeg_quality = 20;
  const auto fine_point = meter.measure({"test", samples(16)}, nullptr);
  const auto rough_point = meter.measure({"test", rough}, nullptr);
  ASSERT_TRUE(fine_point && rough_point);
  EXPECT_EQ(rough_point->relmse, fine_point->relmse);
  EXPECT_EQ(rough_point->rays, fine_point->rays);
  EXPECT_LT(rough_point->bytes, fine_point->bytes);
  EXPECT_LT(rough_point->shown.psnr_db, fine_point->shown.psnr_db);
}

TEST_F(TradeMeterTest, stops_when_cancelled) {
  TradeMeter meter(*renderer_, view(), reference_.mean());
  EXPECT_EQ(meter.measure({"test", samples(1)}, [] { return true; }).error().code(), ErrorCode::kUnavailable);
  EXPECT_FALSE(converged_film(
      *renderer_, view(), [](double) {}, [] { return true; }));
}

TEST_F(TradeMeterTest, a_film_in_pieces_equals_the_film_at_once) {
  const auto pieces = converged_film(
      *renderer_, view(40), [](double) {}, nullptr);
  ASSERT_TRUE(pieces);
  Film once;
  renderer_->render_film(view(40), whole(view()), false, &once, nullptr);
  for (std::size_t i = 0; i < once.sum.data().size(); ++i) {
    EXPECT_NEAR(pieces->sum.data()[i], once.sum.data()[i], 1e-4f * std::abs(once.sum.data()[i]));
  }
}

TEST_F(TradeMeterTest, the_reference_estimates_its_own_noise) {
  const auto few = converged_film(
      *renderer_, view(4), [](double) {}, nullptr);
  ASSERT_TRUE(few);
  EXPECT_LT(own_relmse(reference_), 0.1 * own_relmse(*few));
  EXPECT_GT(own_relmse(reference_), 0.0);
}

}  // namespace
}  // namespace cyclorama::render

// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/denoise/denoising_renderer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/image/cropped.h"
#include "renderfarm/render/tone.h"
#include "tests/data_sets/simple_scenes.h"

namespace cyclorama::denoise {
namespace {

/// A ball in front of a wall in soft light: noise, edges and a shadow.
class DenoisingRendererTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scene::Scene scene = scene_of(sphere_mesh(3.0f, 12));
    add_mesh(scene, sphere_mesh(0.4f, 8), Eigen::Affine3d(Eigen::Translation3d(0, 0, -1.5)));
    scene::Light light = point_light({0.5, 1.0, 0.0}, 2.0f);
    light.radius_m = 0.5f;
    scene.model.lights.push_back(light);
    scene.tone = scene::ToneCurve::kFilmic;
    auto alone = render::Renderer::build(scene, 1, nullptr);
    ASSERT_TRUE(alone) << alone.error().message();
    alone_ = std::move(*alone);
    auto built = render::Renderer::build(std::move(scene), 2, nullptr);
    ASSERT_TRUE(built) << built.error().message();
    renderer_ = std::move(*built);
  }
  static void TearDownTestSuite() {
    renderer_.reset();
    alone_.reset();
  }

  static render::PanoramaView view() {
    render::PanoramaView view = view_from({0, 0, 0}, 200, 150, 0.7, -0.7);
    view.quality.samples = 2;
    view.seed = 3;
    return view;
  }
  static RgbImage picture_of(const PixelRect& rect, int threads) {
    DenoisingRenderer denoising(threads == 1 ? *alone_ : *renderer_);
    RgbImage picture;
    denoising.render(view(), rect, &picture, nullptr);
    return picture;
  }
  static inline std::unique_ptr<render::Renderer> renderer_;
  static inline std::unique_ptr<render::Renderer> alone_;  ///< The same scene with one thread.
};

TEST_F(DenoisingRendererTest, removes_noise_from_flat_and_round_pictures) {
  for (const PictureShape& shape :
       {PictureShape(Perspective{160, 120, -1.0, 1.0, 0.75, -0.75, 0.2}), PictureShape(Fisheye{128, 128, 3.0, 0.5})}) {
    render::PanoramaView noisy = view();
    noisy.projection = Projection{shape, {}};
    ASSERT_TRUE(check_denoisable(noisy));
    const PixelRect all{0, 0, width_px(shape), height_px(shape)};
    render::PanoramaView clean = noisy;
    clean.quality.samples = 256;
    RadianceImage reference;
    RadianceImage plain;
    RadianceImage smooth;
    renderer_->render_radiance(clean, all, &reference, nullptr);
    renderer_->render_radiance(noisy, all, &plain, nullptr);
    DenoisingRenderer(*renderer_).render_radiance(noisy, all, &smooth, nullptr);
    const auto error = [&](const RadianceImage& image) {
      double sum = 0.0;
      for (std::size_t i = 0; i < image.data().size(); ++i) {
        EXPECT_TRUE(std::isfinite(image.data()[i]));
        sum += std::pow(static_cast<double>(image.data()[i] - reference.data()[i]), 2);
      }
      return sum;
    };
    EXPECT_LT(error(smooth), 0.7 * error(plain)) << shape.index();
  }
}

TEST_F(DenoisingRendererTest, denoises_any_part_as_in_the_whole_film_bit_by_bit) {
  render::Film film;
  renderer_->render_film(view(), whole(view()), true, &film, nullptr);
  const RadianceImage light = denoised(film, panorama_rays(view().panorama, view().heading_rad, whole(view())));
  const RgbImage expected = render::developed(light, scene::ToneCurve::kFilmic);
  RgbImage noisy;
  renderer_->render(view(), whole(view()), &noisy, nullptr);
  ASSERT_NE(expected, noisy);
  for (const int threads : {1, 3}) {
    for (const PixelRect& rect : {PixelRect{0, 0, 200, 150}, PixelRect{16, 0, 64, 150}, PixelRect{61, 37, 1, 1},
                                  PixelRect{190, 130, 10, 20}, PixelRect{0, 16, 200, 130}}) {
      EXPECT_EQ(picture_of(rect, threads), cropped(expected, rect))
          << threads << " threads, " << rect.width << "x" << rect.height << " at " << rect.x << ", " << rect.y;
    }
  }
}

TEST_F(DenoisingRendererTest, brings_the_depth_of_the_plain_picture_for_any_part) {
  render::PanoramaView deep = view();
  DenoisingRenderer denoising(*renderer_);
  RgbImage picture;
  InverseDepthImage plain, depth;
  denoising.render(deep, whole(deep), &picture, nullptr, &depth);
  EXPECT_TRUE(depth.empty());
  EXPECT_EQ(picture, picture_of(whole(deep), 2));
  deep.depth = true;
  renderer_->render(deep, whole(deep), &picture, nullptr, &plain);
  for (const PixelRect& rect : {PixelRect{0, 0, 200, 150}, PixelRect{16, 0, 64, 150}, PixelRect{61, 37, 1, 1},
                                PixelRect{190, 130, 10, 20}, PixelRect{48, 48, 16, 16}}) {
    denoising.render(deep, rect, &picture, nullptr, &depth);
    EXPECT_EQ(depth, cropped(plain, depth_cells(rect))) << rect.x << ", " << rect.y;
    EXPECT_EQ(picture, picture_of(rect, 2));
  }
}

TEST_F(DenoisingRendererTest, handles_another_size_and_an_empty_one_with_the_same_memory) {
  DenoisingRenderer denoising(*renderer_);
  RgbImage first, small, empty, again;
  denoising.render(view(), whole(view()), &first, nullptr);
  denoising.render(view(), {32, 32, 16, 16}, &small, nullptr);
  denoising.render(view(), {32, 32, 0, 0}, &empty, nullptr);
  denoising.render(view(), whole(view()), &again, nullptr);
  EXPECT_EQ(small, cropped(first, {32, 32, 16, 16}));
  EXPECT_TRUE(empty.empty());
  EXPECT_EQ(again, first);
}

TEST_F(DenoisingRendererTest, counts_the_rays_of_the_margin) {
  const PixelRect part{48, 48, 16, 16};
  RgbImage picture;
  const render::RenderCost plain = renderer_->render(view(), part, &picture, nullptr);
  const render::RenderCost cost = DenoisingRenderer(*renderer_).render(view(), part, &picture, nullptr);
  EXPECT_GT(cost.rays, 4 * plain.rays);
  EXPECT_GT(cost.wall_seconds, 0.0);
}

TEST_F(DenoisingRendererTest, counts_the_processor_time_of_the_filter) {
  auto renderer = render::Renderer::build(scene_of(sphere_mesh(3.0f, 4)), 1, nullptr);
  ASSERT_TRUE(renderer) << renderer.error().message();
  DenoisingRenderer denoising(**renderer);
  render::PanoramaView cheap = view();
  cheap.eye = {0, 100, 0};  // With almost nothing visible, filtering takes about as long as rendering the film.
  cheap.quality.samples = 1;
  RadianceImage light;
  render::Film film;
  double with = 0.0, without = 0.0;
  for (int i = 0; i < 6; ++i) {  // Alternates, so that a temporary slowdown affects both.
    with += denoising.render_radiance(cheap, whole(cheap), &light, nullptr).cpu_seconds;
    without += (*renderer)->render_film(cheap, whole(cheap), true, &film, nullptr).cpu_seconds;
  }
  EXPECT_GT(with, 1.3 * without);
}

TEST_F(DenoisingRendererTest, attributes_all_costs_of_a_part_to_its_own_cells) {
  DenoisingRenderer denoising(*renderer_);
  RgbImage picture;
  const auto columns_and_rows = [&](const PixelRect& rect, const std::function<bool()>& cancelled) {
    const render::RenderCost cost = denoising.render(view(), rect, &picture, cancelled);
    double sum = 0.0;
    for (const float seconds : cost.cell_cpu_seconds) sum += static_cast<double>(seconds);
    EXPECT_NEAR(sum, cost.cpu_seconds, 1e-5 * cost.cpu_seconds);
    return cost.cell_cpu_seconds.size();
  };
  EXPECT_EQ(columns_and_rows({48, 48, 32, 16}, nullptr), 2u);
  EXPECT_EQ(columns_and_rows({0, 0, 200, 150}, nullptr), 13u * 10u);
  EXPECT_EQ(columns_and_rows({190, 130, 10, 20}, nullptr), 2u * 2u);
  EXPECT_EQ(columns_and_rows({32, 32, 0, 0}, nullptr), 0u);
  EXPECT_EQ(columns_and_rows({48, 48, 32, 16}, [] { return true; }), 2u);
}

TEST_F(DenoisingRendererTest, stops_when_it_is_cancelled) {
  RgbImage picture;
  DenoisingRenderer(*renderer_).render(view(), whole(view()), &picture, [] { return true; });
  EXPECT_EQ(picture, RgbImage(200, 150));
}

render::PanoramaView for_eyes(render::PanoramaView view, Eyes eyes, int height_px) {
  view.panorama.height_px = height_px;
  view.projection = Projection{view.panorama, {}};
  view.projection->viewing = {eyes, 0.3, 2.0};
  return view;
}

TEST_F(DenoisingRendererTest, never_mixes_the_eyes_pictures) {
  constexpr int kHeight = 96;
  const render::PanoramaView both = for_eyes(view(), Eyes::kOverUnder, kHeight);
  ASSERT_TRUE(check_denoisable(both));
  DenoisingRenderer denoising(*renderer_);
  RadianceImage all;
  const PixelRect whole{0, 0, 200, 2 * kHeight};
  const render::RenderCost cost = denoising.render_radiance(both, whole, &all, nullptr);
  EXPECT_EQ(cost.cell_cpu_seconds.size(), 13u * 12u);
  // The left eye's picture has the samples of a picture of its own, and no row of the other contributes to it.
  RadianceImage left;
  denoising.render_radiance(for_eyes(view(), Eyes::kLeft, kHeight), {0, 0, 200, kHeight}, &left, nullptr);
  EXPECT_EQ(cropped(all, {0, 0, 200, kHeight}), left);
  // Holds for any requested part, across the seam or beside it.
  for (const PixelRect& rect : {PixelRect{0, kHeight, 200, kHeight}, PixelRect{32, 80, 64, 32},
                                PixelRect{0, 95, 200, 2}, PixelRect{160, 96, 40, 16}}) {
    RadianceImage part;
    denoising.render_radiance(both, rect, &part, nullptr);
    EXPECT_EQ(part, cropped(all, rect)) << rect.y;
  }
  const RadianceImage right = cropped(all, {0, kHeight, 200, kHeight});
  EXPECT_NE(right, left);
  render::PanoramaView deep = both;
  deep.depth = true;
  RgbImage picture;
  InverseDepthImage plain, depth;
  renderer_->render(deep, whole, &picture, nullptr, &plain);
  for (const PixelRect& rect : {whole, PixelRect{32, 80, 64, 32}, PixelRect{160, 96, 40, 16}}) {
    denoising.render(deep, rect, &picture, nullptr, &depth);
    EXPECT_EQ(depth, cropped(plain, depth_cells(rect))) << rect.y;
  }
}

TEST_F(DenoisingRendererTest, removes_noise_from_both_eyes_pictures) {
  constexpr int kHeight = 96;
  const render::PanoramaView noisy = for_eyes(view(), Eyes::kOverUnder, kHeight);
  render::PanoramaView clean = noisy;
  clean.quality.samples = 256;
  RadianceImage reference, plain, smooth;
  const PixelRect whole{0, 0, 200, 2 * kHeight};
  renderer_->render_radiance(clean, whole, &reference, nullptr);
  renderer_->render_radiance(noisy, whole, &plain, nullptr);
  DenoisingRenderer(*renderer_).render_radiance(noisy, whole, &smooth, nullptr);
  for (const int top : {0, kHeight}) {
    double before = 0.0, after = 0.0;
    for (int y = top; y < top + kHeight; ++y) {
      for (int c = 0; c < 600; ++c) {
        const auto off = [&](const RadianceImage& image) {
          return std::pow(static_cast<double>(image.at(0, y)[c] - reference.at(0, y)[c]), 2);
        };
        before += off(plain);
        after += off(smooth);
      }
    }
    EXPECT_LT(after, 0.7 * before) << top;
  }
}

TEST_F(DenoisingRendererTest, requires_a_cut_between_the_eyes_pictures) {
  for (const Eyes eyes : {Eyes::kMono, Eyes::kLeft, Eyes::kRight}) {
    EXPECT_TRUE(check_denoisable(for_eyes(view(), eyes, 150)));
  }
  const Status refused = check_denoisable(for_eyes(view(), Eyes::kOverUnder, 150));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code(), ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace cyclorama::denoise

// SPDX-License-Identifier: Apache-2.0
// Compares the graphics card's drawing with the same in double precision on the CPU.
#include "appliance/display/head_painter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "appliance/display/lit_rects.h"
#include "appliance/display/lit_triangles.h"
#include "common/geometry/guard_band.h"
#include "tests/data_sets/demo_room.h"
#include "tests/support/painted_head.h"

namespace cyclorama::display {
namespace {

using Renderer = output::HeadlessOptions::Renderer;

constexpr double kSlack_px = 0.02;
// Pictures and masks are half floats: each has an error of up to a 4096th.
constexpr double kSlackLight = 1.0 / 2048.0;
constexpr double kTurn = 2.0 * std::numbers::pi;

RgbImage smooth(int width, int height) {
  RgbImage picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      picture.at(x, y)[0] = static_cast<std::uint8_t>(127.5 + 127.0 * std::sin(x * 0.05));
      picture.at(x, y)[1] = static_cast<std::uint8_t>(127.5 + 127.0 * std::sin(y * 0.07));
      picture.at(x, y)[2] = static_cast<std::uint8_t>(255 * x / width);
    }
  }
  return picture;
}

PlanarPicture plain(int width, int height, std::uint8_t code) {
  return JpegEncoder().to_planar(RgbImage(width, height, code));
}

/// Returns a head that shows the whole panorama without distortion.
warp::WarpMesh straight(int width, int height, double span_rad) {
  const auto w = static_cast<float>(width);
  const auto h = static_cast<float>(height);
  const auto half = static_cast<float>(0.5 * span_rad);
  return {width, height, 1, 1, {{0, 0, -half, 0.5f}, {w, 0, half, 0.5f}, {0, h, -half, -0.5f}, {w, h, half, -0.5f}},
          0.0};
}

class HeadPainterTest : public ::testing::TestWithParam<Renderer> {
 protected:
  PaintedHead head_{GetParam()};
};

TEST_P(HeadPainterTest, agrees_with_the_cpu_over_random_warps_masks_and_colours) {
  RandomHeads heads(11);
  double worst = 0.0;
  for (int n = 0; n < 24; ++n) {
    const int width = heads.pixels(16, 140);
    const int height = heads.pixels(16, 110);
    const bool whole_turn = n % 4 == 0;
    const Panorama panorama{n % 8 == 1 ? 16 : heads.pixels(16, 300), n % 8 == 1 ? 16 : heads.pixels(16, 120),
                            whole_turn ? kTurn : heads.between(0.5, 6.0), 0.5, -0.5};
    const bool mapped = n % 3 == 2;
    const double span = panorama.azimuth_span_rad;
    const HeadPlan plan{
        mapped ? warp::Warp(heads.map(width, height, span)) : warp::Warp(heads.mesh(width, height, span, n % 5 == 0)),
        heads.mask(width, height), n < 4 ? warp::HeadColour{} : heads.colour(width, height), 8, n % 2 == 1};
    const PlanarPicture picture = heads.noise(panorama.width_px, panorama.height_px, heads.one_in(2));
    const double shift = heads.between(-1.0, 1.0);
    const RgbImage image = head_.drawn(plan, picture, panorama, shift);
    worst =
        std::max(worst, worst_difference(image, plan, ExactPicture(picture, panorama, shift), kSlack_px, kSlackLight));
    ASSERT_LE(worst, 1.0) << "case " << n;
  }
  std::printf("noise within 0.02 px: worst %.3f code values\n", worst);
}

TEST_P(HeadPainterTest, agrees_with_the_cpu_pixel_for_pixel_on_the_demo) {
  const Installation room = demo_room();
  const Panorama panorama = room.panorama(512);
  const PlanarPicture picture = JpegEncoder().to_planar(smooth(panorama.width_px, panorama.height_px));
  const std::vector<warp::ProjectorMap> maps = warp::projector_maps(room);
  const std::vector<warp::MaskImage> masks = warp::make_blend_masks(maps);
  const ExactPicture reference(picture, panorama, 0.0);
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const auto mesh = warp::make_warp_mesh(maps[i], panorama);
    ASSERT_TRUE(mesh);
    const auto patches = warp::make_warp_patches(maps[i], panorama, 0.05);
    ASSERT_TRUE(patches);
    const auto check = [&](const warp::Warp& warp, Texels texels, bool is_dithered) {
      const HeadPlan plan{warp, masks[i], {}, 8, is_dithered};
      PaintedHead head(GetParam(), texels);
      const double worst = worst_difference(head.drawn(plan, picture, panorama, 0.0), plan, reference, 0.0);
      std::printf("projector %zu: worst %.3f code values\n", i, worst);
      EXPECT_LE(worst, texels == Texels::kHalves ? 0.65 : 0.85);
    };
    check(*mesh, Texels::kPacked, false);
    check(*patches, Texels::kHalves, false);
    check(*patches, Texels::kPacked, true);
    check(warp::make_pixel_map(maps[i], panorama), Texels::kHalves, false);
  }
}

TEST_P(HeadPainterTest, agrees_with_the_cpu_over_random_flat_pictures_and_turned_domes) {
  RandomHeads heads(12);
  double worst = 0.0;
  for (int n = 0; n < 24; ++n) {
    const int width = heads.pixels(16, 140);
    const int height = heads.pixels(16, 110);
    const PictureShape shape = heads.other_shape(heads.pixels(16, 300), heads.pixels(16, 300));
    const bool mapped = n % 2 == 0;
    const bool is_dome = std::holds_alternative<Fisheye>(shape);
    // A pixel of a map may have any direction, also behind a dome's axis.
    const double span = mapped && is_dome ? 4.5 : 1.2;
    HeadPlan plan{
        mapped ? warp::Warp(heads.map(width, height, span)) : warp::Warp(heads.mesh(width, height, span, n % 3 == 0)),
        heads.mask(width, height), warp::HeadColour{}, 8, n % 4 < 2};
    plan.picture = shape;
    const PlanarPicture picture = heads.noise(width_px(shape), height_px(shape), heads.one_in(2));
    const double turn = n % 5 == 0 ? 0.0 : heads.between(-0.3, 0.3);
    const RgbImage image = head_.drawn(plan, picture, shape, turn);
    worst = std::max(worst, worst_difference(image, plan, ExactPicture(picture, shape, turn), kSlack_px, kSlackLight));
    ASSERT_LE(worst, 1.0) << "case " << n;
  }
  std::printf("noise within 0.02 px: worst %.3f code values\n", worst);
}

TEST_P(HeadPainterTest, agrees_with_the_cpu_pixel_for_pixel_on_walls_of_every_shape) {
  for (const char* const name : {"plane", "corner", "dome", "mesh"}) {
    auto room = read_installation(demo_installation_path().parent_path() / (std::string(name) + ".toml"));
    ASSERT_TRUE(room) << room.error().message();
    // Half as many pixels each way take a quarter of the time.
    for (InstalledProjector& projector : room->projectors) {
      Pinhole& lens = projector.lens;
      lens = {lens.width_px / 2, lens.height_px / 2, 0.5 * lens.focal_px, 0.5 * lens.centre_u_px,
              0.5 * lens.centre_v_px};
    }
    const PictureShape wall = room->picture(512);
    const PictureShape shape = with_guard_band(wall, 0.15);
    const PlanarPicture picture = JpegEncoder().to_planar(smooth(width_px(shape), height_px(shape)));
    const std::vector<warp::ProjectorMap> maps = warp::projector_maps(*room);
    const std::vector<warp::MaskImage> masks = warp::make_blend_masks(maps);
    double worst = 0.0;
    for (std::size_t i = 0; i < maps.size(); ++i) {
      const auto warp = warp::make_warp(maps[i], wall);
      ASSERT_TRUE(warp) << warp.error().message();
      HeadPlan plan{*warp, masks[i], {}, 8, false};
      plan.picture = wall;
      for (const double turn : {0.0, -0.15, 0.11}) {
        const ExactPicture reference(picture, shape, turn);
        worst = std::max(worst, worst_difference(head_.drawn(plan, picture, shape, turn), plan, reference, 0.0));
      }
    }
    std::printf("%s: worst %.3f code values\n", name, worst);
    EXPECT_LE(worst, 1.0) << name;
  }
}

TEST_P(HeadPainterTest, finds_the_position_in_a_dome_of_2048_pixels) {
  RandomHeads heads(4);
  for (const double turn : {0.0, 0.25}) {
    const Fisheye dome{2048, 2048, 3.6, 0.8};
    PlanarPicture bars(2048, 2048, false);
    for (int y = 0; y < 2048; ++y) {
      for (int x = 0; x < 2048; ++x) *bars.luma().at(x, y) = (x + y) % 2 == 0 ? 255 : 188;  // Half the light.
    }
    HeadPlan plan{heads.map(97, 41, 3.0), warp::MaskImage(97, 41, 1.0f), {}, 8, false};
    plan.picture = dome;
    const RgbImage image = head_.drawn(plan, bars, dome, turn);
    EXPECT_LE(worst_difference(image, plan, ExactPicture(bars, dome, turn), kSlack_px), 1.0);
  }
}

TEST_P(HeadPainterTest, finds_the_position_in_a_panorama_of_8192_pixels) {
  RandomHeads heads(3);
  for (const bool whole_turn : {false, true}) {
    const Panorama panorama{8192, 32, whole_turn ? kTurn : 3.0, 0.5, -0.5};
    const PlanarPicture picture = heads.noise(8192, 32, false);
    const HeadPlan plan{heads.mesh(97, 41, 0.02), warp::MaskImage(97, 41, 1.0f), {}, 8, false};
    const RgbImage image = head_.drawn(plan, picture, panorama, 0.7);
    EXPECT_LE(worst_difference(image, plan, ExactPicture(picture, panorama, 0.7), kSlack_px), 1.0);
  }
}

TEST_P(HeadPainterTest, turning_shifts_the_picture) {
  RandomHeads heads(5);
  const Panorama panorama{256, 64, 2.56, 0.4, -0.4};  // 0.01 rad per pixel.
  const PlanarPicture picture = heads.noise(256, 64, false);
  PlanarPicture shifted(256, 64, false);
  constexpr int kShift_px = 13;
  const auto shift = [&](const GreyImage& from, GreyImage* to) {
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 256; ++x) *to->at(x, y) = *from.at(std::min(x + kShift_px, 255), y);
    }
  };
  shift(picture.luma(), &shifted.luma());
  shift(picture.blue(), &shifted.blue());
  shift(picture.red(), &shifted.red());
  warp::WarpMesh mesh{100, 60, 1, 1, {}, 0.0};
  mesh.vertices = {{0, 0, -0.6f, 0.35f}, {100, 0, 0.7f, 0.3f}, {0, 60, -0.7f, -0.3f}, {100, 60, 0.6f, -0.38f}};
  const HeadPlan plan{mesh, warp::MaskImage(100, 60, 0.8f)};
  const RgbImage turned = head_.drawn(plan, picture, panorama, 0.01 * kShift_px);
  EXPECT_LE(worst_difference(turned, plan, ExactPicture(shifted, panorama, 0.0), 0.005), 1.0);
}

TEST_P(HeadPainterTest, stays_black_where_the_mask_or_the_warp_is_empty) {
  RandomHeads heads(6);
  const Panorama panorama{64, 64, 1.0, 0.5, -0.5};
  const PlanarPicture white = plain(64, 64, 255);
  HeadPlan plan{heads.mesh(40, 30, 1.0), warp::MaskImage(40, 30, 1.0f)};
  for (int x = 0; x < 40; ++x) *plan.mask.at(x, 0) = 0.0f;
  const RgbImage image = head_.drawn(plan, white, panorama, 0.0);
  for (int x = 0; x < 40; ++x) EXPECT_EQ(image.at(x, 0)[1], 0);
  for (warp::WarpVertex& vertex : std::get<warp::WarpMesh>(plan.warp).vertices) {
    vertex.tan_elevation = std::numeric_limits<float>::quiet_NaN();
  }
  EXPECT_THAT(head_.drawn(plan, white, panorama, 0.0).data(), ::testing::Each(0));
  plan.warp = warp::PixelMap(40, 30, std::numeric_limits<float>::quiet_NaN());
  EXPECT_THAT(head_.drawn(plan, white, panorama, 0.0).data(), ::testing::Each(0));
  plan.warp = straight(40, 30, 1.0);
  plan.mask = warp::MaskImage(40, 30, 0.0f);
  EXPECT_THAT(head_.drawn(plan, white, panorama, 0.0).data(), ::testing::Each(0));
}

TEST_P(HeadPainterTest, follows_a_response_with_a_steep_step) {
  const Panorama panorama{256, 16, 1.0, 0.5, -0.5};
  RgbImage ramp(256, 16);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 256; ++x) std::fill_n(ramp.at(x, y), 3, static_cast<std::uint8_t>(x));
  }
  warp::ResponseCurve step;
  for (int i = 0; i < 256; ++i) step.codes.push_back(i < 100 ? 0.1f : 0.9f);
  HeadPlan plan{straight(256, 16, 1.0), warp::MaskImage(256, 16, 1.0f), {}, 8, false};
  plan.colour.response = std::array{step, warp::ResponseCurve::srgb(256), warp::ResponseCurve::power(2.2, 256)};
  const PlanarPicture picture = JpegEncoder().to_planar(ramp);
  const RgbImage image = head_.drawn(plan, picture, panorama, 0.0);
  // The nearest of 4096 steps is used: within a step's width of the jump, the other side may be visible.
  EXPECT_LE(worst_difference(image, plan, ExactPicture(picture, panorama, 0.0), 0.0, 1.0 / 512.0), 1.0);
  EXPECT_NEAR(image.at(10, 8)[0], 26, 1);
  EXPECT_NEAR(image.at(250, 8)[0], 230, 1);
  EXPECT_NEAR(image.at(250, 8)[1], 250, 1);  // The conversion from sRGB to sRGB changes nothing.
}

TEST_P(HeadPainterTest, dithers_without_changing_the_mean) {
  for (const Texels texels : {Texels::kHalves, Texels::kPacked}) {
    PaintedHead head(GetParam(), texels);
    const double slack = texels == Texels::kHalves ? 0.0 : 0.15;  // Slack for the packed texels' own steps.
    const Panorama panorama{16, 16, 1.0, 0.5, -0.5};
    const PlanarPicture picture = plain(16, 16, 40);
    for (const float weight : {1.0f, 0.93f, 0.71f, 0.5f, 0.37f}) {
      const HeadPlan plan{straight(128, 128, 1.0), warp::MaskImage(128, 128, weight)};
      const RgbImage image = head.drawn(plan, picture, panorama, 0.0);
      const double exact = 255.0 * ExactPicture(picture, panorama, 0.0).code_at(plan, 64, 64)[1];
      double sum = 0.0;
      for (const std::uint8_t code : image.data()) {
        sum += code;
        ASSERT_LE(std::abs(code - exact), 1.0 + slack);
      }
      EXPECT_NEAR(sum / static_cast<double>(image.data().size()), exact, 0.05 + slack) << weight;
      // The mean holds not only over large areas: any 8 x 8 pixels have nearly the mean.
      for (int block = 0; block < 256; ++block) {
        double part = 0.0;
        for (int i = 0; i < 64; ++i) part += *image.at(block % 16 * 8 + i % 8, block / 16 * 8 + i / 8);
        ASSERT_NEAR(part / 64.0, exact, 0.16 + slack);
      }
    }
  }
}

TEST_P(HeadPainterTest, draws_random_patches_as_the_cpu_does) {
  RandomHeads heads(21);
  for (int n = 0; n < 6; ++n) {
    const PictureShape shape =
        n % 3 == 0 ? PictureShape(Panorama{heads.pixels(16, 300), 90, n % 2 == 0 ? kTurn : 2.0, 0.5, -0.5})
                   : heads.other_shape(heads.pixels(16, 300), heads.pixels(16, 300));
    warp::WarpPatches warp{
        heads.pixels(40, 90), heads.pixels(40, 70), 16 * heads.pixels(1, 3), 16 * heads.pixels(1, 3), {}, 0.0};
    for (int i = 0; i < warp.across() * warp.down(); ++i) {
      warp::WarpPatch& patch = warp.patches.emplace_back();
      for (std::array<float, 6>* terms : {&patch.across, &patch.up}) {
        for (float& term : *terms) term = static_cast<float>(heads.between(-0.15, 0.15));
      }
    }
    HeadPlan plan{warp, heads.mask(warp.width_px, warp.height_px), {}, 8, n % 2 == 1};
    plan.picture = shape;
    const PlanarPicture picture = heads.noise(width_px(shape), height_px(shape), true);
    const double turn = heads.between(-0.3, 0.3);
    for (const Texels texels : {Texels::kHalves, Texels::kPacked}) {
      const RgbImage image = PaintedHead(GetParam(), texels).drawn(plan, picture, shape, turn);
      EXPECT_LE(worst_difference(image, plan, ExactPicture(picture, shape, turn), kSlack_px, kSlackLight), 1.0)
          << "case " << n;
    }
  }
}

TEST_P(HeadPainterTest, repeats_the_edges_of_a_picture_smaller_than_the_previous_one) {
  const Panorama large{300, 80, 2.0, 0.5, -0.5};
  const Panorama small{120, 40, 2.0, 0.5, -0.5};
  RandomHeads heads(31);
  const PlanarPicture first = heads.noise(300, 80, false);
  const PlanarPicture then = heads.noise(120, 40, false);
  const HeadPlan plan{straight(200, 60, 3.0), warp::MaskImage(200, 60, 1.0f), {}, 8, false};  // Half a radian beyond.
  for (const Texels texels : {Texels::kHalves, Texels::kPacked}) {
    const RgbImage image = PaintedHead(GetParam(), texels).drawn_after(plan, first, large, then, small);
    EXPECT_LE(worst_difference(image, plan, ExactPicture(then, small, 0.0), kSlack_px), 1.0);
  }
}

TEST_P(HeadPainterTest, dithers_to_the_depth_of_the_output) {
  const Panorama panorama{16, 16, 1.0, 0.5, -0.5};
  HeadPlan plan{straight(64, 64, 1.0), warp::MaskImage(64, 64, 0.71f)};
  plan.depth_bits = 10;  // Noise is less than one code value of 8 bits.
  const RgbImage image = head_.drawn(plan, plain(16, 16, 40), panorama, 0.0);
  EXPECT_LE(worst_difference(image, plan, ExactPicture(plain(16, 16, 40), panorama, 0.0), 0.0), 1.0);
  EXPECT_LE(*std::ranges::max_element(image.data()) - *std::ranges::min_element(image.data()), 1);
  std::size_t differing = 0;
  for (const std::uint8_t code : image.data()) differing += code != image.data()[0] ? 1U : 0U;
  EXPECT_LT(differing, image.data().size() / 3);
}

TEST_P(HeadPainterTest, mixes_two_pictures_in_linear_light) {
  const Panorama panorama{16, 16, 1.0, 0.5, -0.5};
  for (const bool mapped : {false, true}) {
    HeadPlan plan{straight(32, 32, 1.0), warp::MaskImage(32, 32, 1.0f), {}, 8, false};
    if (mapped) plan.warp = warp::PixelMap(32, 32, 0.0f);
    const RgbImage image = head_.faded(plan, plain(16, 16, 0), plain(16, 16, 255), panorama, 0.25);
    const double expected = 255.0 * (1.055 * std::pow(0.25, 1.0 / 2.4) - 0.055);
    EXPECT_THAT(image.data(),
                ::testing::Each(::testing::AllOf(::testing::Ge(expected - 1), ::testing::Le(expected + 1))));
  }
}

TEST_P(HeadPainterTest, has_no_seam_where_a_full_circle_closes) {
  const Panorama panorama{64, 16, kTurn, 0.5, -0.5};
  RandomHeads heads(9);
  const PlanarPicture picture = heads.noise(64, 16, true);
  const HeadPlan plan{straight(640, 16, 0.6), warp::MaskImage(640, 16, 1.0f), {}, 8, false};
  const RgbImage image = head_.drawn(plan, picture, panorama, std::numbers::pi);
  EXPECT_LE(worst_difference(image, plan, ExactPicture(picture, panorama, std::numbers::pi), kSlack_px), 1.0);
}

INSTANTIATE_TEST_SUITE_P(Headless, HeadPainterTest, ::testing::Values(Renderer::kEgl, Renderer::kOsMesa),
                         [](const auto& tested) { return tested.param == Renderer::kEgl ? "egl" : "osmesa"; });

TEST(LitTriangles, are_split_by_whether_they_need_the_mask) {
  warp::WarpMesh mesh{40, 40, 4, 4, {}, 0.0};
  for (int j = 0; j <= 4; ++j) {
    for (int i = 0; i <= 4; ++i)
      mesh.vertices.push_back({10.0f * static_cast<float>(i), 10.0f * static_cast<float>(j), 0, 0});
  }
  warp::MaskImage mask(40, 40, 1.0f);
  for (int y = 0; y < 40; ++y) *mask.at(39, y) = 0.5f;  // The last column of cells is masked.
  for (int x = 0; x < 40; ++x) {
    for (int y = 0; y < 11; ++y) *mask.at(x, y) = 0.0f;  // The first row is black, down to the second's first pixel.
  }
  const LitTriangles lit = lit_triangles(mesh, mask);
  EXPECT_EQ(lit.whole.size(), 3U * 2U * 3U * 2U);  // 3 columns, the 2 lower rows.
  EXPECT_EQ(lit.masked.size(), 3U * 2U * 6U);      // The second row, and the last column below it.
}

TEST(LitRects, cover_the_lit_area_once_and_mark_where_the_mask_is_one) {
  const warp::WarpPatches warp{300, 170, 128, 96, std::vector<warp::WarpPatch>(6), 0.0};
  RandomHeads heads(8);
  for (int n = 0; n < 20; ++n) {
    warp::MaskImage mask(300, 170, 0.0f);
    for (int blob = 0; blob < 3; ++blob) {
      const int left = heads.pixels(0, 280);
      const int top = heads.pixels(0, 150);
      const float weight = heads.one_in(2) ? 1.0f : 0.5f;
      for (int y = top; y < std::min(170, top + 90); ++y) {
        for (int x = left; x < std::min(300, left + 110); ++x) *mask.at(x, y) = weight;
      }
    }
    const LitRects rects = lit_rects(warp, mask);
    warp::MaskImage drawn(300, 170, 0.0f);
    for (const std::vector<LitRect>* kind : {&rects.whole, &rects.masked}) {
      for (const LitRect& rect : *kind) {
        for (int y = rect.part.y; y < rect.part.y + rect.part.height; ++y) {
          for (int x = rect.part.x; x < rect.part.x + rect.part.width; ++x) {
            *drawn.at(x, y) += 1.0f;
            ASSERT_EQ(rect.patch, static_cast<std::size_t>(y / 96 * 3 + x / 128));
            ASSERT_TRUE(kind != &rects.whole || *mask.at(x, y) == 1.0f);
          }
        }
      }
    }
    for (std::size_t i = 0; i < mask.data().size(); ++i) {
      ASSERT_LE(drawn.data()[i], 1.0f);
      ASSERT_TRUE(mask.data()[i] == 0.0f || drawn.data()[i] == 1.0f);
    }
  }
}

}  // namespace
}  // namespace cyclorama::display

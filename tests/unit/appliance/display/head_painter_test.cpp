// SPDX-License-Identifier: Apache-2.0
// What the graphics card draws, against the same in double precision on the CPU.
#include "appliance/display/head_painter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "drivers/output/headless/headless_output.h"
#include "tests/doubles/demo_room.h"
#include "tests/doubles/warped_picture.h"

namespace cyclorama {
namespace {

using Renderer = HeadlessOptions::Renderer;
using Random = std::mt19937;

double between(Random* random, double a, double b) { return std::uniform_real_distribution(a, b)(*random); }

RgbImage noise(int width, int height, Random* random) {
  RgbImage picture(width, height);
  for (std::uint8_t& value : picture.data()) value = static_cast<std::uint8_t>((*random)());
  return picture;
}

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

/// Cells that look anywhere in and a little beyond a panorama; some of them nowhere.
WarpMesh random_mesh(int width, int height, double span_rad, Random* random) {
  WarpMesh mesh{width, height, 1 + static_cast<int>((*random)() % 9), 1 + static_cast<int>((*random)() % 9), {}, 0.0};
  for (int j = 0; j <= mesh.cells_y; ++j) {
    for (int i = 0; i <= mesh.cells_x; ++i) {
      WarpVertex vertex{static_cast<float>(width) * static_cast<float>(i) / static_cast<float>(mesh.cells_x),
                        static_cast<float>(height) * static_cast<float>(j) / static_cast<float>(mesh.cells_y),
                        static_cast<float>(between(random, -0.6, 0.6) * span_rad),
                        static_cast<float>(between(random, -0.6, 0.6))};
      if ((*random)() % 20 == 0) vertex.azimuth_rad = std::numeric_limits<float>::quiet_NaN();
      mesh.vertices.push_back(vertex);
    }
  }
  return mesh;
}

MaskImage random_mask(int width, int height, Random* random) {
  MaskImage mask(width, height);
  for (float& factor : mask.data()) {
    factor = static_cast<float>(std::clamp(between(random, -0.2, 1.2), 0.0, 1.0));
  }
  return mask;
}

class HeadPainting : public ::testing::TestWithParam<Renderer> {
 protected:
  /// Draws one head; the picture from its upper row downwards.
  RgbImage drawn(const WarpMesh& mesh, const MaskImage& mask, const RgbImage& picture, const Panorama& panorama,
                 double shift) {
    auto output = open_headless_output({{{"head", mesh.width_px, mesh.height_px}}, 100.0, {}, GetParam()}, clock_);
    EXPECT_TRUE(output) << output.error().message();
    const Gl& gl = (*output)->gl();
    auto program = WarpProgram::make(gl);
    EXPECT_TRUE(program) << program.error().message();
    auto painter = HeadPainter::make(gl, *program, mesh, mask);
    EXPECT_TRUE(painter) << painter.error().message();
    PanoramaTexture texture(gl);
    Frame frame;
    frame.panorama = panorama;
    frame.picture = std::make_shared<const RgbImage>(picture);
    EXPECT_TRUE(texture.upload(frame));
    EXPECT_TRUE((*output)->draw_to(0));
    painter->draw(texture, shift);
    RgbaImage read_back(mesh.width_px, mesh.height_px);
    gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl.ReadPixels(0, 0, mesh.width_px, mesh.height_px, GL_RGBA, GL_UNSIGNED_BYTE, read_back.data().data());
    EXPECT_TRUE(gl.check("drawing"));
    RgbImage result(mesh.width_px, mesh.height_px);
    to_picture(read_back, &result);
    return result;
  }

  /// A pixel's centre on the edge of a triangle that is left out may be drawn or not: cards snap corners to 1/256 px.
  static bool is_on_the_rim(const WarpMesh& mesh, int x, int y) {
    constexpr double kSnap_px = 1.0 / 64.0;
    int drawn = 0;
    for (int off = 0; off < 4; ++off) {
      const Eigen::Vector2d near(x + 0.5 + (off % 2 == 0 ? -kSnap_px : kSnap_px),
                                 y + 0.5 + (off < 2 ? -kSnap_px : kSnap_px));
      drawn += mesh.interpolate(near) ? 1 : 0;
    }
    return drawn != 0 && drawn != 4;
  }

  /// The largest distance in code values from what the reference gives anywhere within `slack_px`.
  static double worst_difference(const RgbImage& drawn, const WarpMesh& mesh, const MaskImage& mask,
                                 const WarpedPicture& reference, double slack_px) {
    double worst = 0.0;
    for (int y = 0; y < drawn.height(); ++y) {
      for (int x = 0; x < drawn.width(); ++x) {
        if (is_on_the_rim(mesh, x, y)) continue;
        std::array<double, 3> least = reference.at(mesh, mask, x, y);
        std::array<double, 3> most = least;
        for (int off = 0; slack_px > 0.0 && off < 9; ++off) {
          const auto moved = reference.at(mesh, mask, x, y, (off % 3 - 1) * slack_px, (off / 3 - 1) * slack_px);
          for (std::size_t c = 0; c < 3; ++c) least[c] = std::min(least[c], moved[c]);
          for (std::size_t c = 0; c < 3; ++c) most[c] = std::max(most[c], moved[c]);
        }
        for (std::size_t c = 0; c < 3; ++c) {
          const double value = drawn.at(x, y)[c];
          worst = std::max({worst, least[c] - value, value - most[c]});
        }
      }
    }
    return worst;
  }
  SteadyClock clock_;
};

TEST_P(HeadPainting, agrees_with_the_cpu_over_random_meshes_and_masks) {
  Random random(11);
  double worst = 0.0;
  for (int n = 0; n < 16; ++n) {
    const int width = 20 + static_cast<int>(random() % 120);
    const int height = 20 + static_cast<int>(random() % 90);
    const bool whole_turn = n % 4 == 0;
    Panorama panorama{16 + static_cast<int>(random() % 300), 16 + static_cast<int>(random() % 100),
                      whole_turn ? 2.0 * std::numbers::pi : between(&random, 0.5, 6.0), 0.5, -0.5};
    const WarpMesh mesh = random_mesh(width, height, panorama.azimuth_span_rad, &random);
    const MaskImage mask = random_mask(width, height, &random);
    const RgbImage picture = noise(panorama.width_px, panorama.height_px, &random);
    const double shift = between(&random, -1.0, 1.0);
    const RgbImage image = drawn(mesh, mask, picture, panorama, shift);
    worst = std::max(worst, worst_difference(image, mesh, mask, WarpedPicture(picture, panorama, shift), 0.02));
    ASSERT_LE(worst, 1.0) << "case " << n;
  }
  std::printf("noise within 0.02 px: worst %.3f code values\n", worst);
}

TEST_P(HeadPainting, agrees_with_the_cpu_pixel_for_pixel_on_the_demo) {
  const Installation room = demo_room();
  const Panorama panorama = room.panorama(512);
  const RgbImage picture = smooth(panorama.width_px, panorama.height_px);
  const std::vector<ProjectorMap> maps = projector_maps(room);
  const std::vector<MaskImage> masks = make_blend_masks(maps);
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const auto mesh = make_warp_mesh(maps[i], panorama);
    ASSERT_TRUE(mesh);
    const RgbImage image = drawn(*mesh, masks[i], picture, panorama, 0.0);
    const double worst = worst_difference(image, *mesh, masks[i], WarpedPicture(picture, panorama, 0.0), 0.0);
    std::printf("projector %zu: worst %.3f code values\n", i, worst);
    EXPECT_LE(worst, 1.0);
  }
}

TEST_P(HeadPainting, of_a_turned_visitor_is_the_shifted_picture) {
  Random random(5);
  const Panorama panorama{256, 64, 2.56, 0.4, -0.4};  // 0.01 rad per pixel.
  const RgbImage picture = noise(256, 64, &random);
  RgbImage shifted(256, 64);
  constexpr int kShift_px = 13;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 256; ++x) std::copy_n(picture.at(std::min(x + kShift_px, 255), y), 3, shifted.at(x, y));
  }
  WarpMesh mesh{100, 60, 1, 1, {}, 0.0};
  mesh.vertices = {{0, 0, -0.6f, 0.35f}, {100, 0, 0.7f, 0.3f}, {0, 60, -0.7f, -0.3f}, {100, 60, 0.6f, -0.38f}};
  const MaskImage mask(100, 60, 0.8f);
  const RgbImage turned = drawn(mesh, mask, picture, panorama, 0.01 * kShift_px);
  const double worst = worst_difference(turned, mesh, mask, WarpedPicture(shifted, panorama, 0.0), 0.005);
  EXPECT_LE(worst, 1.0);
}

TEST_P(HeadPainting, leaves_black_where_the_mask_or_the_mesh_is_empty) {
  Random random(6);
  const Panorama panorama{64, 64, 1.0, 0.5, -0.5};
  const RgbImage white(64, 64, 255);
  WarpMesh mesh = random_mesh(40, 30, 1.0, &random);
  MaskImage mask(40, 30, 1.0f);
  for (int x = 0; x < 40; ++x) *mask.at(x, 0) = 0.0f;
  const RgbImage image = drawn(mesh, mask, white, panorama, 0.0);
  for (int x = 0; x < 40; ++x) EXPECT_EQ(image.at(x, 0)[1], 0);
  for (WarpVertex& vertex : mesh.vertices) vertex.tan_elevation = std::numeric_limits<float>::quiet_NaN();
  const RgbImage nothing = drawn(mesh, mask, white, panorama, 0.0);
  EXPECT_THAT(nothing.data(), ::testing::Each(0));
}

INSTANTIATE_TEST_SUITE_P(Headless, HeadPainting, ::testing::Values(Renderer::kEgl, Renderer::kOsMesa),
                         [](const auto& tested) { return tested.param == Renderer::kEgl ? "egl" : "osmesa"; });

}  // namespace
}  // namespace cyclorama

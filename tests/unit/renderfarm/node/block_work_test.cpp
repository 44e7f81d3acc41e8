// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/block_work.h"

#include <gtest/gtest.h>

#include <span>
#include <string_view>

#include "common/image/watermark.h"
#include "tests/doubles/fake_block_renderer.h"

namespace cyclorama::node {
namespace {

enum class Kind { kMoving, kDenoised, kAtRest };

std::vector<RenderedTile> tiles(Kind kind, std::uint64_t watermark, bool depth = false) {
  auto order = std::make_shared<BlockOrder>();
  order->renderer = std::make_shared<FakeBlockRenderer>(std::make_shared<FakeRendering>());
  wire::RenderBlock& block = order->block;
  block.set_block(1);
  block.set_x_px(64);
  block.set_y_px(32);
  block.set_width_px(600);
  block.set_height_px(300);
  block.set_keep(kind == Kind::kAtRest);
  block.set_watermark(watermark);
  wire::View& view = *block.mutable_view();
  view.set_number(1);
  view.set_samples(2);
  view.set_jpeg_quality(85);
  view.set_denoise(kind == Kind::kDenoised);
  view.set_depth(depth);
  view.mutable_panorama()->set_width_px(1024);
  view.mutable_panorama()->set_height_px(512);
  view.mutable_panorama()->set_azimuth_span_rad(2.0);
  view.mutable_panorama()->set_tan_elevation_top(0.5);
  view.mutable_panorama()->set_tan_elevation_bottom(-0.5);
  auto work = BlockWork::begin(order);
  EXPECT_TRUE(work) << work.error().message();
  FilmStore films;
  std::vector<RenderedTile> made;
  render::Crew crew(2);
  while (!work->is_done()) {
    for (RenderedTile& tile : work->next_tiles(films, crew, {[] { return false; }, [] { return false; }})) {
      made.push_back(std::move(tile));
    }
  }
  return made;
}

class BlockWorkMarks : public testing::TestWithParam<Kind> {};

TEST_P(BlockWorkMarks, every_tile_by_its_position_in_the_picture_if_there_is_a_key) {
  constexpr std::uint64_t kKey = 0x9e1f2bad2af9ea4e;
  const std::vector<RenderedTile> plain = tiles(GetParam(), 0);
  const std::vector<RenderedTile> marked = tiles(GetParam(), kKey);
  ASSERT_GT(plain.size(), 1u);
  ASSERT_EQ(marked.size(), plain.size());
  for (std::size_t i = 0; i < plain.size(); ++i) {
    EXPECT_NE(marked[i].pixels, plain[i].pixels);
    RgbImage expected = plain[i].pixels;
    add_watermark(kKey, plain[i].rect, &expected);
    EXPECT_EQ(marked[i].pixels, expected);
  }
}

class BlockWorkDepth : public testing::TestWithParam<Kind> {};

TEST_P(BlockWorkDepth, comes_with_every_tile_of_a_moving_picture_whose_view_requests_it) {
  const std::vector<RenderedTile> without = tiles(GetParam(), 0);
  const std::vector<RenderedTile> with = tiles(GetParam(), 0, true);
  ASSERT_GT(with.size(), 1u);
  ASSERT_EQ(with.size(), without.size());
  for (std::size_t i = 0; i < with.size(); ++i) {
    EXPECT_TRUE(without[i].depth.empty());
    EXPECT_EQ(with[i].pixels, without[i].pixels);
    if (GetParam() == Kind::kAtRest) {
      EXPECT_TRUE(with[i].depth.empty());
    } else {
      EXPECT_EQ(with[i].depth, fake_depth(depth_cells(with[i].rect)));
    }
  }
}

/// A picture at rest of one row of tiles that begins with stored light.
class BlockWorkPrior : public testing::Test {
 protected:
  BlockWorkPrior() {
    EXPECT_TRUE(renderer->add_light(std::as_bytes(std::span(std::string_view("light"))), "light"));
    view.set_number(1);
    view.set_jpeg_quality(95);
    view.set_sequence(8);
    view.mutable_panorama()->set_width_px(512);
    view.mutable_panorama()->set_height_px(256);
    view.mutable_panorama()->set_azimuth_span_rad(2.0);
    view.mutable_panorama()->set_tan_elevation_top(0.5);
    view.mutable_panorama()->set_tan_elevation_bottom(-0.5);
  }
  void begin_with_light(float weight) {
    view.set_light(renderer->light_versions()->newest()->version);
    view.set_prior_samples(4);
    view.set_prior_weight(weight);
  }
  /// Adds the samples [first, end) and returns the pixels of the block.
  RgbImage refined(int first, int end, const PixelRect& rect = {0, 0, 256, 256}) {
    auto order = std::make_shared<BlockOrder>();
    order->renderer = renderer;
    wire::RenderBlock& block = order->block;
    block.set_block(1);
    block.set_x_px(static_cast<std::uint32_t>(rect.x));
    block.set_y_px(static_cast<std::uint32_t>(rect.y));
    block.set_width_px(static_cast<std::uint32_t>(rect.width));
    block.set_height_px(static_cast<std::uint32_t>(rect.height));
    block.set_keep(true);
    *block.mutable_view() = view;
    block.mutable_view()->set_first_sample(static_cast<std::uint32_t>(first));
    block.mutable_view()->set_samples(static_cast<std::uint32_t>(end - first));
    auto work = BlockWork::begin(order);
    EXPECT_TRUE(work) << work.error().message();
    auto tiles = work->next_tiles(films, crew, {[] { return false; }, [this] { return --cells_until_preempted == 0; }});
    if (tiles.empty()) tiles = work->next_tiles(films, crew, {[] { return false; }, [] { return false; }});
    return std::move(tiles.at(0).pixels);
  }

  std::shared_ptr<FakeRendering> rendering = std::make_shared<FakeRendering>();
  std::shared_ptr<FakeBlockRenderer> renderer = std::make_shared<FakeBlockRenderer>(rendering);
  wire::View view;
  FilmStore films;
  render::Crew crew{1};
  int cells_until_preempted = -1;
};

TEST_F(BlockWorkPrior, is_most_of_the_first_picture_and_nothing_of_the_last) {
  const RgbImage paths_first = refined(0, 1);
  const RgbImage paths_last = refined(1, 8);
  begin_with_light(1e6f);
  const RgbImage first = refined(0, 1);
  EXPECT_NE(first, paths_first);
  const RgbImage middle = refined(1, 4);
  for (std::size_t i = 0; i < first.data().size(); ++i) {
    ASSERT_NEAR(middle.data()[i], first.data()[i], 1) << "its weight is so large that paths change nothing yet";
  }
  EXPECT_EQ(refined(4, 8), paths_last) << "the reference is that of paths alone, bit by bit";
}

TEST_F(BlockWorkPrior, gives_the_same_pixels_however_the_picture_is_divided_refined_or_interrupted) {
  begin_with_light(3.0f);
  refined(0, 1);
  const RgbImage steps = refined(1, 4);
  films.forget({});
  EXPECT_EQ(refined(1, 4), steps) << "a node that lost its sums";
  const RgbImage part = refined(0, 4, {64, 32, 128, 128});
  for (int y = 0; y < 128; ++y) {
    for (int c = 0; c < 3 * 128; ++c) ASSERT_EQ(part.at(0, y)[c], steps.at(64, 32 + y)[c]);
  }
  films.forget({});
  cells_until_preempted = 5;
  EXPECT_EQ(refined(0, 4), steps) << "interrupted while the light is read";
}

TEST_F(BlockWorkPrior, is_rendered_once_for_all_steps) {
  begin_with_light(3.0f);
  refined(0, 1);
  EXPECT_EQ(rendering->samples, 4 + 1);
  refined(1, 2);
  EXPECT_EQ(rendering->samples, 4 + 2);
}

TEST(BlockWork, renders_the_largest_denoised_block_in_parts_of_bounded_memory) {
  auto order = std::make_shared<BlockOrder>();
  const auto rendering = std::make_shared<FakeRendering>();
  order->renderer = std::make_shared<FakeBlockRenderer>(rendering);
  wire::RenderBlock& block = order->block;
  block.set_width_px(4096);
  block.set_height_px(1040);
  wire::View& view = *block.mutable_view();
  view.set_number(1);
  view.set_samples(1);
  view.set_jpeg_quality(85);
  view.set_denoise(true);
  view.mutable_panorama()->set_width_px(4096);
  view.mutable_panorama()->set_height_px(1040);
  view.mutable_panorama()->set_azimuth_span_rad(2.0);
  view.mutable_panorama()->set_tan_elevation_top(0.5);
  view.mutable_panorama()->set_tan_elevation_bottom(-0.5);
  auto work = BlockWork::begin(order);
  ASSERT_TRUE(work) << work.error().message();
  FilmStore films;
  render::Crew crew(2);
  int tiles = 0;
  while (!work->is_done()) {
    const auto row = work->next_tiles(films, crew, {[] { return false; }, [] { return false; }});
    ASSERT_EQ(row.size(), 16u) << "one row of tiles at a time, more would exceed the limit";
    for (const RenderedTile& tile : row) {
      RadianceImage expected;
      render::PanoramaView same;
      same.panorama = {4096, 1040, 2.0, 0.5, -0.5};
      same.seed = 1;
      InverseDepthImage depth;
      order->renderer->begin_denoised(same, tile.rect)->advance([] { return false; }, &expected, &depth);
      EXPECT_EQ(tile.pixels, order->renderer->developed(expected)) << tiles;
      ++tiles;
    }
  }
  EXPECT_EQ(tiles, 16 * 5);
  EXPECT_EQ(rendering->renders, tiles + 5);
}

INSTANTIATE_TEST_SUITE_P(OfAllKinds, BlockWorkDepth, testing::Values(Kind::kMoving, Kind::kDenoised, Kind::kAtRest));
INSTANTIATE_TEST_SUITE_P(OfAllKinds, BlockWorkMarks, testing::Values(Kind::kMoving, Kind::kDenoised, Kind::kAtRest));

}  // namespace
}  // namespace cyclorama::node

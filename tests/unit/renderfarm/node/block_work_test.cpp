// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/block_work.h"

#include <gtest/gtest.h>

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
  while (!work->is_done()) made.push_back(*work->next_tile(films, {[] { return false; }, [] { return false; }}));
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
  int tiles = 0;
  while (!work->is_done()) {
    const auto tile = work->next_tile(films, {[] { return false; }, [] { return false; }});
    ASSERT_TRUE(tile);
    RgbImage expected(tile->rect.width, tile->rect.height);
    render::PanoramaView same;
    same.panorama = {4096, 1040, 2.0, 0.5, -0.5};
    same.seed = 1;
    InverseDepthImage depth;
    order->renderer->begin_denoised(same, tile->rect)->advance([] { return false; }, &expected, &depth);
    EXPECT_EQ(tile->pixels, expected) << tiles;
    ++tiles;
  }
  EXPECT_EQ(tiles, 16 * 5);
  EXPECT_EQ(rendering->renders, tiles + 5) << "one row of tiles at a time, more would exceed the limit";
}

INSTANTIATE_TEST_SUITE_P(OfAllKinds, BlockWorkDepth, testing::Values(Kind::kMoving, Kind::kDenoised, Kind::kAtRest));
INSTANTIATE_TEST_SUITE_P(OfAllKinds, BlockWorkMarks, testing::Values(Kind::kMoving, Kind::kDenoised, Kind::kAtRest));

}  // namespace
}  // namespace cyclorama::node

// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/client/view_window.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "common/wire/convert.h"
#include "tests/doubles/fake_scene.h"

namespace cyclorama::client {
namespace {

using testing::HasSubstr;

wire::View view_of(std::uint64_t number, std::uint32_t width = 64, std::uint32_t height = 32) {
  wire::View view;
  view.set_number(number);
  view.set_samples(1);
  view.set_jpeg_quality(80);
  view.mutable_panorama()->set_width_px(width);
  view.mutable_panorama()->set_height_px(height);
  view.mutable_panorama()->set_azimuth_span_rad(1.0);
  view.mutable_panorama()->set_tan_elevation_top(0.5);
  view.mutable_panorama()->set_tan_elevation_bottom(-0.5);
  return view;
}

wire::View dome_of(std::uint64_t number, int size_px, double tilt_rad) {
  wire::View view = view_of(number);
  to_wire(Fisheye{size_px, size_px, 3.0, tilt_rad}, view.mutable_panorama());
  return view;
}

wire::SessionReply opened() {
  wire::SessionReply reply;
  *reply.mutable_opened() = fake_scene("plain");
  return reply;
}

wire::SessionReply begin_of(const wire::View& view) {
  wire::SessionReply reply;
  *reply.mutable_begin() = view;
  return reply;
}

wire::SessionReply begin_of(std::uint64_t number, std::uint32_t width = 64, std::uint32_t height = 32) {
  return begin_of(view_of(number, width, height));
}

wire::SessionReply tile_of(std::uint64_t number, std::uint32_t x, std::uint32_t width) {
  wire::SessionReply reply;
  wire::Tile& tile = *reply.mutable_tile();
  tile.set_view_number(number);
  tile.set_x_px(x);
  tile.set_width_px(width);
  tile.set_height_px(32);
  return reply;
}

wire::SessionReply end_of(std::uint64_t number, std::uint32_t tiles, bool complete = true) {
  wire::SessionReply reply;
  wire::FrameEnd& end = *reply.mutable_end();
  end.set_view_number(number);
  end.set_tiles(tiles);
  end.set_complete(complete);
  return reply;
}

/// Returns the window of an open session.
ViewWindow open_window() {
  ViewWindow window;
  CHECK(window.take(opened()));
  return window;
}

TEST(ViewWindow, expects_the_scene_first_and_once) {
  ViewWindow window;
  window.put(view_of(1));
  EXPECT_FALSE(window.take_sendable()) << "nobody knows yet what is to be seen";
  EXPECT_THAT(window.take(begin_of(1)).error().message(), HasSubstr("the scene first"));
  wire::SessionReply nowhere = opened();
  nowhere.mutable_opened()->clear_walkable();
  EXPECT_FALSE(window.take(nowhere));
  EXPECT_FALSE(window.is_opened());
  ASSERT_TRUE(window.take(opened()));
  EXPECT_THAT(window.take(opened()).error().message(), HasSubstr("once"));
  EXPECT_THAT(window.take({}).error().message(), HasSubstr("unknown"));
  EXPECT_TRUE(window.take_sendable());
}

TEST(ViewWindow, refuses_overlapping_tiles_whose_pixels_add_up) {
  ViewWindow window = open_window();
  window.put(view_of(1));
  ASSERT_TRUE(window.take_sendable());
  ASSERT_TRUE(window.take(begin_of(1)));
  ASSERT_TRUE(window.take(tile_of(1, 0, 48)));
  EXPECT_THAT(window.take(tile_of(1, 32, 16)).error().message(), HasSubstr("(32, 0) over another"));
  EXPECT_FALSE(window.take(end_of(1, 2)));
  EXPECT_TRUE(window.take(tile_of(1, 48, 16)));
  EXPECT_TRUE(window.take(end_of(1, 2)));
}

TEST(ViewWindow, refuses_a_frame_from_another_position) {
  ViewWindow window = open_window();
  window.put(view_of(1));
  ASSERT_TRUE(window.take_sendable());
  wire::View turned = view_of(1);
  turned.set_heading_rad(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(window.take(begin_of(turned)).error().message(), HasSubstr("another position"));
  wire::View moved = view_of(1);
  moved.mutable_eye_m()->set_y(1e300);
  EXPECT_FALSE(window.take(begin_of(moved)));
  wire::View shapeless = view_of(1, 0);
  EXPECT_EQ(window.take(begin_of(shapeless)).error().code(), ErrorCode::kBadData);
  EXPECT_TRUE(window.take(begin_of(1)));
}

TEST(ViewWindow, expects_the_requested_eyes_in_a_frame) {
  const auto two = [](std::uint64_t number, int height_px, double distance_m) {
    wire::View view = view_of(number);
    Projection picture{Panorama{64, height_px, 1.0, 0.5, -0.5}, {}};
    picture.viewing = {Eyes::kOverUnder, distance_m, 3.0};
    to_wire(picture, view.mutable_panorama());
    return view;
  };
  ViewWindow window = open_window();
  window.put(two(1, 32, 0.063));
  ASSERT_TRUE(window.take_sendable());
  EXPECT_THAT(window.take(begin_of(view_of(1, 64, 64))).error().message(), HasSubstr("another shape"));
  EXPECT_THAT(window.take(begin_of(two(1, 32, 0.07))).error().message(), HasSubstr("another shape"));
  ASSERT_TRUE(window.take(begin_of(two(1, 16, 0.063)))) << "fewer pixels";
  ASSERT_TRUE(window.take(tile_of(1, 0, 32))) << "a tile may have pixels of both";
  EXPECT_FALSE(window.take(end_of(1, 1)));
  ASSERT_TRUE(window.take(tile_of(1, 32, 32)));
  EXPECT_TRUE(window.take(end_of(1, 2)));
}

TEST(ViewWindow, sends_two_views_and_keeps_only_the_newest_of_the_rest) {
  ViewWindow window = open_window();
  EXPECT_FALSE(window.put(view_of(1)));
  EXPECT_EQ(window.take_sendable()->number(), 1u);
  EXPECT_FALSE(window.put(view_of(2)));
  EXPECT_EQ(window.take_sendable()->number(), 2u);
  EXPECT_FALSE(window.put(view_of(3)));
  EXPECT_FALSE(window.take_sendable());
  EXPECT_TRUE(window.put(view_of(4)));
  EXPECT_TRUE(window.take(begin_of(1)));
  EXPECT_FALSE(window.take_sendable());
  EXPECT_TRUE(window.take(end_of(1, 0, false)));
  EXPECT_EQ(window.take_sendable()->number(), 4u);
  EXPECT_EQ(window.in_flight(), 2u);
}

TEST(ViewWindow, forgets_the_numbers_that_the_farm_skips) {
  ViewWindow window = open_window();
  for (std::uint64_t n : {1u, 2u}) {
    window.put(view_of(n));
    ASSERT_TRUE(window.take_sendable());
  }
  EXPECT_TRUE(window.take(begin_of(2)));
  EXPECT_EQ(window.in_flight(), 1u);
  EXPECT_FALSE(window.take(end_of(1, 0, false)));
}

TEST(ViewWindow, accepts_a_complete_frame_and_refuses_one_with_a_hole) {
  ViewWindow window = open_window();
  for (std::uint64_t n : {1u, 2u}) {
    window.put(view_of(n));
    ASSERT_TRUE(window.take_sendable());
  }
  ASSERT_TRUE(window.take(begin_of(1)));
  EXPECT_TRUE(window.take(tile_of(1, 0, 32)));
  EXPECT_TRUE(window.take(tile_of(1, 32, 32)));
  EXPECT_TRUE(window.take(end_of(1, 2)));
  ASSERT_TRUE(window.take(begin_of(2)));
  EXPECT_TRUE(window.take(tile_of(2, 0, 32)));
  EXPECT_FALSE(window.take(end_of(2, 1)));
}

TEST(ViewWindow, refuses_messages_out_of_order) {
  ViewWindow window = open_window();
  for (std::uint64_t n : {1u, 2u}) {
    window.put(view_of(n));
    ASSERT_TRUE(window.take_sendable());
  }
  EXPECT_FALSE(window.take(tile_of(1, 0, 32)));
  EXPECT_FALSE(window.take(end_of(1, 0)));
  EXPECT_FALSE(window.take(begin_of(7)));
  EXPECT_FALSE(window.take(begin_of(1, 128)));
  ASSERT_TRUE(window.take(begin_of(1)));
  EXPECT_FALSE(window.take(begin_of(2)));
  EXPECT_FALSE(window.take(tile_of(2, 0, 32)));
  EXPECT_FALSE(window.take(tile_of(1, 48, 32)));
  EXPECT_FALSE(window.take(tile_of(1, 8, 32)));
  EXPECT_TRUE(window.take(tile_of(1, 0, 32)));
  EXPECT_EQ(window.take(tile_of(1, 0, 32)).error().code(), ErrorCode::kBadData);
}

TEST(ViewWindow, accepts_a_frame_with_fewer_pixels_and_checks_its_tiles_by_its_own_size) {
  ViewWindow window = open_window();
  window.put(view_of(1, 64, 64));
  ASSERT_TRUE(window.take_sendable());
  EXPECT_FALSE(window.take(begin_of(1, 64, 65)));
  wire::View other_field = view_of(1, 32, 32);
  other_field.mutable_panorama()->set_azimuth_span_rad(1.1);
  EXPECT_FALSE(window.take(begin_of(other_field)));
  ASSERT_TRUE(window.take(begin_of(1, 48, 32)));
  EXPECT_FALSE(window.take(tile_of(1, 32, 32)));
  EXPECT_TRUE(window.take(tile_of(1, 0, 48)));
  EXPECT_TRUE(window.take(end_of(1, 1)));
}

TEST(ViewWindow, accepts_a_refined_last_frame_even_while_a_newer_view_is_in_flight) {
  ViewWindow window = open_window();
  window.put(view_of(1));
  ASSERT_TRUE(window.take_sendable());
  ASSERT_TRUE(window.take(begin_of(1, 32)));
  ASSERT_TRUE(window.take(tile_of(1, 0, 32)));
  ASSERT_TRUE(window.take(end_of(1, 1)));
  for (int again = 0; again < 2; ++again) {
    ASSERT_TRUE(window.take(begin_of(1)));
    EXPECT_EQ(window.in_flight(), again == 0 ? 0u : 1u);
    EXPECT_TRUE(window.take(tile_of(1, 0, 64)));
    window.put(view_of(2 + static_cast<std::uint64_t>(again)));
    window.take_sendable();
    EXPECT_TRUE(window.take(end_of(1, 1)));
  }
  EXPECT_EQ(window.in_flight(), 2u);
  ASSERT_TRUE(window.take(begin_of(2)));
  EXPECT_TRUE(window.take(end_of(2, 0, false)));
  EXPECT_FALSE(window.take(begin_of(1))) << "2 was answered since";
}

TEST(ViewWindow, expects_no_refined_frame_from_another_farm) {
  ViewWindow window = open_window();
  window.put(view_of(1));
  ASSERT_TRUE(window.take_sendable());
  ASSERT_TRUE(window.take(begin_of(1)));
  ASSERT_TRUE(window.take(end_of(1, 0, false)));
  EXPECT_EQ(window.lose(), std::nullopt);
  ASSERT_TRUE(window.take(opened()));
  EXPECT_FALSE(window.take(begin_of(1)));
}

TEST(ViewWindow, requests_the_newest_view_again_after_a_loss) {
  ViewWindow window = open_window();
  for (std::uint64_t n : {1u, 2u}) {
    window.put(view_of(n));
    ASSERT_TRUE(window.take_sendable());
  }
  ASSERT_TRUE(window.take(begin_of(1)));
  EXPECT_EQ(window.lose(), 1u);
  EXPECT_FALSE(window.take_sendable()) << "no session is open";
  ASSERT_TRUE(window.take(opened()));
  EXPECT_EQ(window.take_sendable()->number(), 2u);
  window.put(view_of(3));
  EXPECT_EQ(window.lose(), std::nullopt);
  ASSERT_TRUE(window.take(opened()));
  EXPECT_EQ(window.take_sendable()->number(), 3u);
  EXPECT_FALSE(window.take_sendable());
}

TEST(ViewWindow, accepts_a_requested_dome_with_fewer_pixels_only) {
  ViewWindow window = open_window();
  window.put(dome_of(1, 64, 0.5));
  ASSERT_TRUE(window.take_sendable());
  EXPECT_THAT(window.take(begin_of(dome_of(1, 64, 0.4))).error().message(), HasSubstr("another shape"));
  EXPECT_THAT(window.take(begin_of(dome_of(1, 80, 0.5))).error().message(), HasSubstr("another shape"));
  EXPECT_THAT(window.take(begin_of(1)).error().message(), HasSubstr("another shape"));
  EXPECT_TRUE(window.take(begin_of(dome_of(1, 32, 0.5))));
}

}  // namespace
}  // namespace cyclorama::client

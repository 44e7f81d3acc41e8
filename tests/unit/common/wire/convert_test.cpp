// SPDX-License-Identifier: Apache-2.0
#include "common/wire/convert.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace cyclorama {
namespace {

using ::testing::HasSubstr;

wire::View good_view() {
  wire::View view;
  view.set_number(1);
  to_wire(Eigen::Vector3d(1.0, 1.6, -2.0), view.mutable_eye_m());
  to_wire(Panorama{640, 320, 2.0, 0.5, -0.5}, view.mutable_panorama());
  view.set_samples(1);
  view.set_jpeg_quality(85);
  return view;
}

TEST(Convert, pictures_of_every_projection_survive_a_round_trip) {
  wire::Panorama wire;
  for (const PictureShape& shape :
       {PictureShape(Panorama{1920, 1088, 2.2, 0.41, -0.42}),
        PictureShape(Perspective{1200, 700, -0.9, 1.1, 0.6, -0.5, 0.2}), PictureShape(Fisheye{1024, 1000, 2.9, 0.7}),
        PictureShape(Panorama{640, 320, 2.0, 0.5, -0.5})}) {
    to_wire(shape, &wire);  // Overwrites the previous shape.
    const auto back = from_wire(wire);
    ASSERT_TRUE(back) << back.error().message();
    EXPECT_EQ(*back, (Projection{shape, {}}));
  }
}

TEST(Convert, encodes_a_panorama_as_before_there_were_other_projections) {
  wire::Panorama wire;
  to_wire(Panorama{16, 8, 0.0, 0.0, 0.0}, &wire);
  EXPECT_EQ(wire.SerializeAsString(), std::string("\x08\x10\x10\x08"));
}

Projection for_two(const PictureShape& shape) {
  Projection picture{shape, {}};
  picture.viewing.eyes = Eyes::kOverUnder;
  picture.viewing.eye_distance_m = 0.063;
  picture.viewing.screen_distance_m = 3.0;
  return picture;
}

TEST(Convert, two_eyes_survive_a_round_trip_and_one_costs_no_byte) {
  for (const PictureShape& shape :
       {PictureShape(Panorama{1920, 1088, 2.2, 0.41, -0.42}),
        PictureShape(Perspective{1200, 704, -0.9, 1.1, 0.6, -0.5, 0.2}), PictureShape(Fisheye{1024, 1008, 2.9, 0.7})}) {
    wire::Panorama one;
    to_wire(shape, &one);
    wire::Panorama wire;
    to_wire(Projection{shape, {}}, &wire);
    EXPECT_EQ(wire.SerializeAsString(), one.SerializeAsString());
    Projection both = for_two(shape);
    to_wire(both, &wire);
    EXPECT_EQ(wire.height_px(), 2 * one.height_px()) << "who only counts pixels need not know of eyes";
    EXPECT_EQ(*from_wire(wire), both);
    both.viewing.screen_distance_m = std::numeric_limits<double>::infinity();
    to_wire(both, &wire);
    EXPECT_EQ(*from_wire(wire), both);
    to_wire(shape, &wire);
    EXPECT_EQ(*from_wire(wire), (Projection{shape, {}})) << "over what was left there";
  }
}

TEST(Convert, wrong_eyes_are_named) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](auto&& damage) {
    wire::View view = good_view();
    to_wire(for_two(Panorama{640, 320, 2.0, 0.5, -0.5}), view.mutable_panorama());
    EXPECT_TRUE(validate(view));
    damage(view.mutable_panorama());
    const Status status = validate(view);
    return status ? std::string("accepted") : status.error().message();
  };
  for (const std::uint32_t height : {0U, 16U, 631U, 656U, 4294967295U}) {
    EXPECT_THAT(refused([&](auto* p) { p->set_height_px(height); }), HasSubstr("height_px")) << height;
  }
  EXPECT_THAT(refused([](auto* p) { p->set_height_px(32768); }), HasSubstr("height_px"));
  for (const double distance : {0.0, -0.063, 1.5, nan, std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(refused([&](auto* p) { p->mutable_eyes()->set_distance_m(distance); }), HasSubstr("eyes.distance_m"));
  }
  for (const double distance : {-1.0, 0.03, nan}) {  // At 0.03 m the eyes would be behind the screen.
    EXPECT_THAT(refused([&](auto* p) { p->mutable_eyes()->set_screen_distance_m(distance); }),
                HasSubstr("screen_distance_m"));
  }
}

TEST(Convert, reports_an_unknown_projection) {
  wire::View view = good_view();
  // An unknown projection, as a later program might send it.
  ASSERT_TRUE(view.mutable_panorama()->MergeFromString("\x30\x07"));
  const Status status = validate(view);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(status.error().message(), HasSubstr("projection is 7, which this program does not support; update it"));
}

TEST(Convert, checks_other_projections_too) {
  const auto refused = [](const PictureShape& shape) {
    wire::View view = good_view();
    to_wire(shape, view.mutable_panorama());
    const Status status = validate(view);
    return status ? std::string("accepted") : status.error().message();
  };
  EXPECT_EQ(refused(Perspective{640, 480, -1.0, 1.0, 0.7, -0.7, 0.1}), "accepted");
  EXPECT_EQ(refused(Fisheye{640, 640, 3.0, 0.1}), "accepted");
  EXPECT_THAT(refused(Perspective{640, 480, 1.0, -1.0, 0.7, -0.7, 0.1}), HasSubstr("tan_right"));
  EXPECT_THAT(refused(Perspective{640, 480, -1.0, 2e4, 0.7, -0.7, 0.1}), HasSubstr("beyond a tangent"));
  EXPECT_THAT(refused(Fisheye{640, 640, 7.0, 0.1}), HasSubstr("field_rad"));
  EXPECT_THAT(refused(Fisheye{640, 640, 3.0, std::numeric_limits<double>::quiet_NaN()}), HasSubstr("tilt_rad"));
}

TEST(Convert, accepts_a_valid_view) {
  wire::View view = good_view();
  EXPECT_TRUE(validate(view).has_value());
  view.set_samples(1024);
  view.set_first_sample(3072);
  view.set_sequence(4096);
  view.set_bounces(64);
  view.set_light_samples(16);
  view.set_firefly_limit(10.0f);
  view.set_adaptive_error(0.01f);
  view.set_adaptive_minimum(2);
  EXPECT_TRUE(validate(view).has_value());
}

TEST(Convert, names_each_invalid_field_of_a_view) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](auto&& damage) {
    wire::View view = good_view();
    damage(view);
    const Status status = validate(view);
    return status ? std::string("accepted") : status.error().message();
  };
  EXPECT_THAT(refused([](auto& v) { v.set_number(0); }), HasSubstr("number"));
  EXPECT_THAT(refused([&](auto& v) { v.mutable_eye_m()->set_y(nan); }), HasSubstr("eye_m"));
  EXPECT_THAT(refused([&](auto& v) { v.set_heading_rad(-1.0 / 0.0); }), HasSubstr("heading_rad"));
  EXPECT_THAT(refused([](auto& v) { v.set_samples(5000); }), HasSubstr("samples"));
  EXPECT_THAT(refused([](auto& v) { v.set_jpeg_quality(0); }), HasSubstr("jpeg_quality"));
  EXPECT_THAT(refused([](auto& v) { v.set_first_sample(4096); }), HasSubstr("first_sample"));
  EXPECT_THAT(refused([](auto& v) { v.set_sequence(4097); }), HasSubstr("sequence"));
  EXPECT_THAT(refused([](auto& v) { v.set_bounces(65); }), HasSubstr("bounces"));
  EXPECT_THAT(refused([](auto& v) { v.set_light_samples(17); }), HasSubstr("light_samples"));
  EXPECT_THAT(refused([&](auto& v) { v.add_lamp_levels(static_cast<float>(nan)); }), HasSubstr("lamp_levels"));
  EXPECT_THAT(refused([](auto& v) { v.add_lamp_levels(-0.5f); }), HasSubstr("lamp_levels"));
  EXPECT_THAT(refused([](auto& v) { v.add_lamp_levels(4.5f); }), HasSubstr("lamp_levels"));
  EXPECT_THAT(refused([](auto& v) {
                for (int group = 0; group < 8; ++group) v.add_lamp_levels(1.0f);
              }),
              HasSubstr("are 8; there may be 7"));
  EXPECT_THAT(refused([&](auto& v) { v.set_firefly_limit(static_cast<float>(nan)); }), HasSubstr("firefly_limit"));
  EXPECT_THAT(refused([](auto& v) { v.set_adaptive_error(-0.1f); }), HasSubstr("adaptive_error"));
  EXPECT_THAT(refused([](auto& v) { v.set_adaptive_minimum(1); }), HasSubstr("adaptive_minimum"));
  EXPECT_THAT(refused([](auto& v) { v.mutable_panorama()->set_width_px(4294967295u); }), HasSubstr("width_px"));
  EXPECT_THAT(refused([](auto& v) { v.mutable_panorama()->set_azimuth_span_rad(7.0); }), HasSubstr("azimuth_span"));
  EXPECT_THAT(refused([](auto& v) { v.mutable_panorama()->set_tan_elevation_top(-0.5); }), HasSubstr("top"));
}

TEST(Convert, limits_a_tiles_depth_to_its_values_and_a_header) {
  wire::Tile tile;
  tile.set_width_px(17);
  tile.set_height_px(12);
  for (const std::size_t bytes : {0u, 1u, 2u * 5 * 3 + 1024}) {
    tile.set_depth(std::string(bytes, 'd'));
    EXPECT_TRUE(validate(tile, 64, 64)) << bytes;
  }
  tile.set_depth(std::string(2 * 5 * 3 + 1025, 'd'));
  const Status refused = validate(tile, 64, 64);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(refused.error().message(), HasSubstr("1055 bytes of depth"));
}

TEST(Convert, requires_tiles_inside_the_picture_on_the_grid) {
  const auto fits = [&](std::uint32_t x, std::uint32_t y, std::uint32_t w, std::uint32_t h) {
    wire::Tile tile;
    tile.set_x_px(x);
    tile.set_y_px(y);
    tile.set_width_px(w);
    tile.set_height_px(h);
    return validate(tile, 100, 60).has_value();
  };
  EXPECT_TRUE(fits(0, 0, 100, 60));
  EXPECT_TRUE(fits(96, 48, 4, 12));
  EXPECT_FALSE(fits(96, 48, 5, 12));
  EXPECT_FALSE(fits(8, 0, 16, 16));
  EXPECT_FALSE(fits(0, 0, 0, 16));
  EXPECT_FALSE(fits(16, 0, 4294967295u, 16));
}

}  // namespace
}  // namespace cyclorama

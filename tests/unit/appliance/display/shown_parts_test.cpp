// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/shown_parts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "common/geometry/guard_band.h"
#include "common/geometry/picture_place.h"
#include "tests/data_sets/demo_room.h"

namespace cyclorama::display {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

struct Heads {
  std::vector<warp::Warp> warps;
  std::vector<warp::MaskImage> masks;
  std::vector<HeadFootprint> footprints;
};

Heads heads_of(const Installation& room, const PictureShape& picture) {
  Heads heads;
  const std::vector<warp::ProjectorMap> maps = warp::projector_maps(room);
  heads.masks = warp::make_blend_masks(maps);
  for (std::size_t i = 0; i < maps.size(); ++i) {
    heads.warps.push_back(*warp::make_warp(maps[i], picture));
    heads.footprints.emplace_back(heads.warps[i], heads.masks[i]);
  }
  return heads;
}

bool has(const ShownParts& shown, double u, double v) {
  return shown.meets({static_cast<int>(std::floor(u)), static_cast<int>(std::floor(v)), 1, 1});
}

/// Expects that every texel that any lit pixel of any head reads, at any turn within the limit, lies in a part.
void expect_all_that_is_read(const Heads& heads, const PictureShape& picture, const ShownParts& shown) {
  std::mt19937 random(4);
  const PixelScale scale = pixel_scale(picture);
  const double width = width_px(picture);
  const double height = height_px(picture);
  const auto* const panorama = std::get_if<Panorama>(&picture);
  for (std::size_t i = 0; i < heads.warps.size(); ++i) {
    const warp::MaskImage& mask = heads.masks[i];
    for (int n = 0; n < 20000; ++n) {
      const int x = static_cast<int>(random() % static_cast<unsigned>(mask.width()));
      const int y = static_cast<int>(random() % static_cast<unsigned>(mask.height()));
      const auto direction = direction_at(heads.warps[i], x, y);
      if (!(*mask.at(x, y) > 0.0f) || !direction) continue;
      const double share =
          n % 2 == 0 ? std::uniform_int_distribution(-1, 1)(random) : std::uniform_real_distribution(-1.0, 1.0)(random);
      const auto position =
          turned(picture, {direction->azimuth_rad, direction->tan_elevation}, share * shown.turn_limit_rad);
      ASSERT_TRUE(position);
      auto [u, v] = scale.pixel_at(*position);
      if (panorama != nullptr && panorama->azimuth_span_rad > 6.28) u -= width * std::floor(u / width);
      for (const double off : {-2.0, 0.0, 2.0}) {
        const double column = std::clamp(u + off, 0.0, width - 0.5);
        const double row = std::clamp(v + off, 0.0, height - 0.5);
        ASSERT_TRUE(has(shown, column, row)) << i << " " << x << " " << y << " " << u << " " << v;
      }
    }
  }
}

std::int64_t area(const ShownParts& shown) {
  std::int64_t sum = 0;
  for (const PixelRect& part : shown.parts) sum += part.area();
  return sum;
}

TEST(ShownParts, contain_all_that_the_demo_reads_and_do_not_overlap) {
  const Installation room = demo_room();
  for (const int width : {256, 1024, 3000}) {
    const Panorama wall = room.panorama(width);
    const Heads heads = heads_of(room, wall);
    const Panorama guarded = wall.with_guard_band(0.2);
    const ShownParts shown = shown_parts(heads.footprints, guarded, wall);
    EXPECT_NEAR(shown.turn_limit_rad, 0.2, 0.02);
    expect_all_that_is_read(heads, guarded, shown);
    for (std::size_t i = 0; i < shown.parts.size(); ++i) {
      const PixelRect& part = shown.parts[i];
      EXPECT_TRUE(part.x % 16 == 0 && part.y % 16 == 0 && !part.empty());
      EXPECT_LE(part.x + part.width, guarded.width_px);
      EXPECT_LE(part.y + part.height, guarded.height_px);
      for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE((ShownParts{0.0, {shown.parts[j]}}).meets(part));
    }
  }
}

TEST(ShownParts, contain_all_that_walls_of_every_shape_read) {
  for (const char* const name : {"plane", "corner", "dome", "mesh"}) {
    const auto room = read_installation(demo_installation_path().parent_path() / (std::string(name) + ".toml"));
    ASSERT_TRUE(room) << room.error().message();
    for (const int width : {200, 1500}) {
      const PictureShape wall = room->picture(width);
      Heads heads = heads_of(*room, wall);
      const PictureShape guarded = with_guard_band(wall, 0.2);
      const ShownParts all = shown_parts(heads.footprints, guarded, wall);
      EXPECT_GE(all.turn_limit_rad, 0.2 - 1e-9) << name;
      EXPECT_LE(all.turn_limit_rad, 0.3) << name;  // Widths are rounded up to 16 pixels.
      expect_all_that_is_read(heads, guarded, all);
      for (const PixelRect& part : all.parts) {
        EXPECT_TRUE(part.x % 16 == 0 && part.y % 16 == 0 && !part.empty());
        EXPECT_LE(part.x + part.width, width_px(guarded));
        EXPECT_LE(part.y + part.height, height_px(guarded));
      }
      // A single head does not need the others' parts.
      heads.footprints.erase(heads.footprints.begin() + 1, heads.footprints.end());
      heads.warps.resize(1);
      heads.masks.resize(1);
      const ShownParts one = shown_parts(heads.footprints, guarded, wall);
      expect_all_that_is_read(heads, guarded, one);
      EXPECT_LT(area(one), 0.85 * static_cast<double>(area(all))) << name;
    }
  }
}

TEST(ShownParts, contain_what_a_visitor_who_walks_will_see) {
  const Installation room = demo_room();
  const PictureShape wall = room.projection(1024, 0).shape;
  const PictureShape picture = with_guard_band(wall, 0.1, 0.08);
  const auto& panorama = std::get<Panorama>(picture);
  const double beyond_px = pixel_scale(picture).pixel_at({0.0, std::get<Panorama>(wall).tan_elevation_top}).v;
  ASSERT_GT(beyond_px, 20.0);
  const Heads heads = heads_of(room, wall);
  const ShownParts shown = shown_parts(heads.footprints, picture, wall);
  for (std::size_t i = 0; i < heads.warps.size(); ++i) {
    for (int y = 0; y < heads.masks[i].height(); y += 7) {
      for (int x = 0; x < heads.masks[i].width(); x += 7) {
        const auto direction = direction_at(heads.warps[i], x, y);
        if (!(*heads.masks[i].at(x, y) > 0.0f) || !direction) continue;
        const auto [u, v] = pixel_scale(picture).pixel_at({direction->azimuth_rad, direction->tan_elevation});
        for (const double rows : {-beyond_px + 2.0, beyond_px - 2.0}) {
          ASSERT_TRUE(has(shown, std::clamp(u, 0.0, panorama.width_px - 0.5),
                          std::clamp(v + rows, 0.0, panorama.height_px - 0.5)))
              << i << ' ' << x << ' ' << y;
        }
      }
    }
  }
}

TEST(ShownParts, allow_unlimited_turning_of_a_fully_lit_dome) {
  const Fisheye dome{512, 512, 3.0, 0.5 * std::numbers::pi};
  warp::PixelMap all(200, 200);
  warp::PixelMap quarter(200, 200);
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 200; ++x) {
      // Covers a disc of 1.45 rad, and a sector of it.
      const double away = 1.45 * (y + 0.5) / 200.0;
      const double around = kTurn * x / 199.0;
      for (warp::PixelMap* map : {&all, &quarter}) {
        const double angle = map == &all ? around : 0.25 * around;
        map->at(x, y)[0] = static_cast<float>(away * std::cos(angle));
        map->at(x, y)[1] = static_cast<float>(away * std::sin(angle));
      }
    }
  }
  const warp::MaskImage lit(200, 200, 1.0f);
  EXPECT_NEAR(shown_parts({HeadFootprint(all, lit)}, dome, dome).turn_limit_rad, std::numbers::pi, 1e-12);
  const ShownParts part = shown_parts({HeadFootprint(quarter, lit)}, dome, dome);
  EXPECT_EQ(part.turn_limit_rad, 0.5);
  expect_all_that_is_read({{quarter}, {lit}, {}}, dome, part);
  EXPECT_LT(area(part), 512 * 512 * 6 / 10);
}

TEST(ShownParts, cover_only_a_part_of_the_circle_for_one_projector_at_any_heading) {
  Installation room = demo_room();
  const Panorama circle{2048, 400, kTurn, 0.6, -0.6};
  room.projectors.resize(1);
  std::get<CylinderWall>(room.wall).arc_rad = kTurn;
  for (const double pan : {0.0, 1.5, 3.1, -3.0}) {
    room.projectors[0].T_room_projector = {Eigen::AngleAxisd(pan, Eigen::Vector3d::UnitY()) *
                                               Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()),
                                           Eigen::Vector3d(0.0, 1.6, 0.0)};
    const Heads heads = heads_of(room, circle);
    const ShownParts shown = shown_parts(heads.footprints, circle, Panorama{1000, 400, 2.0, 0.6, -0.6});
    EXPECT_EQ(shown.turn_limit_rad, 0.5);
    expect_all_that_is_read(heads, circle, shown);
    EXPECT_LT(area(shown), 2048 * 400 / 2);  // 60 degrees, and half a radian on either side.
    const ShownParts kept = shown_parts(heads.footprints, circle, Panorama{1000, 400, 2.0, 0.6, -0.6}, true);
    EXPECT_EQ(kept.turn_limit_rad, std::numbers::pi);
    expect_all_that_is_read(heads, circle, kept);
  }
}

TEST(ShownParts, allow_unlimited_turning_of_a_full_circle_wall) {
  warp::PixelMap map(256, 100);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 256; ++x) {
      map.at(x, y)[0] = static_cast<float>(kTurn * (x / 255.0 - 0.5));
      map.at(x, y)[1] = 0.5f - static_cast<float>(y) / 99.0f;
    }
  }
  const HeadFootprint footprint(map, warp::MaskImage(256, 100, 1.0f));
  const Panorama wall{512, 90, kTurn, 0.5, -0.5};
  const ShownParts shown = shown_parts({footprint}, wall, wall);
  EXPECT_EQ(area(shown), 512 * 90);
  EXPECT_NEAR(shown.turn_limit_rad, std::numbers::pi, 1e-12);
}

TEST(ShownParts, are_empty_for_a_head_that_lights_nothing) {
  const warp::PixelMap map(8, 8, std::numeric_limits<float>::quiet_NaN());
  const warp::PixelMap dark(8, 8, 0.0f);
  for (const PictureShape& wall :
       {PictureShape(Panorama{64, 64, 1.0, 0.5, -0.5}), PictureShape(Fisheye{64, 64, 1.0})}) {
    EXPECT_TRUE(shown_parts({HeadFootprint(map, warp::MaskImage(8, 8, 1.0f))}, wall, wall).parts.empty());
    EXPECT_TRUE(shown_parts({HeadFootprint(dark, warp::MaskImage(8, 8, 0.0f))}, wall, wall).parts.empty());
  }
}

TEST(ShownParts, are_the_same_for_both_eyes) {
  const ShownParts one{0.2, {{0, 16, 64, 32}, {96, 0, 4, 80}}};
  const ShownParts both = shown_by_both_eyes(one, 80);
  EXPECT_EQ(both.turn_limit_rad, 0.2);
  EXPECT_EQ(both.parts, (std::vector<PixelRect>{{0, 16, 64, 32}, {96, 0, 4, 80}, {0, 96, 64, 32}, {96, 80, 4, 80}}));
}

}  // namespace
}  // namespace cyclorama::display

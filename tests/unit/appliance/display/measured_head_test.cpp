// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/measured_head.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "appliance/interchange/display_warp.h"
#include "appliance/interchange/mpcdi.h"
#include "appliance/interchange/warp_file.h"
#include "tests/data_sets/demo_room.h"

namespace cyclorama::display {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::size_t kMiddle = 1;

/// The demo's room with half of its pixels, and a folder for the files of another program.
class MeasuredHead : public ::testing::Test {
 protected:
  MeasuredHead()
      : room_(demo_room_with_pixels_over(2)),
        masks_(warp::make_blend_masks(warp::projector_maps(room_))),
        folder_(std::filesystem::temp_directory_path() / ("measured_head_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
    picture_ = room_.panorama(1024);
    const warp::ProjectorMap map(room_, kMiddle);
    const auto mesh = warp::make_warp_mesh(map, picture_);
    CHECK(mesh.has_value());
    flat_.buffers.push_back({"wall", 0, 0, {interchange::region_of(*mesh, masks_[kMiddle], picture_, "any name")}});
  }
  ~MeasuredHead() override { std::filesystem::remove_all(folder_); }

  Result<HeadPlan> read(const std::filesystem::path& file, const std::string& region = "",
                        const std::filesystem::path& mask = {}) {
    room_.projectors[kMiddle].warp = InstalledWarp{file, region, mask};
    return measured_head(room_, kMiddle, picture_);
  }

  /// Compares with the true room, on the wall, except for the rim of the mapped area.
  void expect_the_room(const Result<HeadPlan>& head, double max_px) const {
    ASSERT_TRUE(head.has_value()) << head.error().message();
    const warp::ProjectorMap map(room_, kMiddle);
    const PixelScale scale = pixel_scale(picture_);
    const warp::MaskImage& mask = masks_[kMiddle];
    double worst_px = 0.0;
    int lit = 0;
    for (int y = 1; y + 1 < mask.height(); ++y) {
      for (int x = 1; x + 1 < mask.width(); ++x) {
        const bool is_inside = *mask.at(x - 1, y) > 0 && *mask.at(x + 1, y) > 0 && *mask.at(x, y - 1) > 0 &&
                               *mask.at(x, y + 1) > 0 && *mask.at(x, y) > 0;
        if (!is_inside) continue;
        const auto truth = map.direction_of({x + 0.5, y + 0.5});
        const auto read = direction_at(head->warp, x, y);
        ASSERT_TRUE(truth && read) << x << ", " << y;
        worst_px = std::max(worst_px, scale.distance_px({truth->azimuth_rad, truth->tan_elevation},
                                                        {read->azimuth_rad, read->tan_elevation}));
        EXPECT_NEAR(*head->mask.at(x, y), *mask.at(x, y), 1e-4);
        ++lit;
      }
    }
    EXPECT_LT(worst_px, max_px);
    EXPECT_GT(lit, mask.width() * mask.height() / 2);
  }

  Installation room_;
  std::vector<warp::MaskImage> masks_;
  Panorama picture_;
  interchange::WarpSet flat_;  ///< The middle projector, over the whole picture.
  std::filesystem::path folder_;
};

TEST_F(MeasuredHead, takes_the_region_of_its_name_from_a_rooms_file) {
  ASSERT_TRUE(interchange::write_mpcdi(folder_ / "wall.mpcdi", interchange::set_of(room_)));
  const auto head = read(folder_ / "wall.mpcdi");
  expect_the_room(head, 0.2);
  EXPECT_FALSE(head->colour.black_lift.has_value());
  EXPECT_TRUE(read(folder_ / "wall.mpcdi", "left").has_value());
}

TEST_F(MeasuredHead, becomes_a_pixel_map_where_no_mesh_fits) {
  interchange::WarpSet room = interchange::set_of(room_);
  for (interchange::WarpRegion& region : room.buffers[0].regions) {
    for (int y = 0; y < region.height_px; ++y) {  // Simulates a wavy wall.
      for (int x = 0; x < region.width_px; ++x) region.map->at(x, y)[1] += (x % 2 == 0 ? 0.02f : -0.02f);
    }
  }
  ASSERT_TRUE(interchange::write_mpcdi(folder_ / "wall.mpcdi", room));
  const auto head = read(folder_ / "wall.mpcdi");
  ASSERT_TRUE(head.has_value()) << head.error().message();
  ASSERT_TRUE(std::holds_alternative<warp::PixelMap>(head->warp));
  const auto truth = warp::ProjectorMap(room_, kMiddle).direction_of({160.5, 120.5});
  EXPECT_GT(direction_at(head->warp, 160, 120)->tan_elevation, truth->tan_elevation + 0.003);
}

TEST_F(MeasuredHead, takes_flat_maps_and_meshes_for_the_requested_picture) {
  for (const char* const name : {"a.mpcdi", "a.pfm", "a.data", "a.obj"}) {
    const bool is_pair = std::string_view(name) == "a.pfm";
    ASSERT_TRUE(interchange::write_warp_file(folder_ / name, {flat_, {}, {}}, "", {.grid = {{129, 97}}, .mask = {}}))
        << name;
    const auto head = read(folder_ / name, "", is_pair ? folder_ / "a.png" : "");
    ASSERT_TRUE(head.has_value()) << head.error().message();
    const auto truth = warp::ProjectorMap(room_, kMiddle).direction_of({160.5, 120.5});
    const auto middle = direction_at(head->warp, 160, 120);
    ASSERT_TRUE(middle.has_value()) << name;
    EXPECT_NEAR(middle->azimuth_rad, truth->azimuth_rad, 1e-3) << name;
    EXPECT_NEAR(middle->tan_elevation, truth->tan_elevation, 1e-3) << name;
    if (is_pair) expect_the_room(head, 0.2);
  }
}

TEST_F(MeasuredHead, adds_the_light_of_a_beta_map) {
  interchange::WarpRegion& region = flat_.buffers[0].regions[0];
  region.beta = interchange::MaskMap(1, 1, 1, 8);
  region.beta->samples = {51};
  flat_.level = 2;
  ASSERT_TRUE(interchange::write_mpcdi(folder_ / "wall.mpcdi", flat_));
  const auto head = read(folder_ / "wall.mpcdi");
  ASSERT_TRUE(head.has_value()) << head.error().message();
  const Eigen::Vector3d shone = warp::shone_light(head->colour, Eigen::Vector3d::Zero(),
                                                  static_cast<double>(*head->colour.black_lift->at(160, 120)));
  EXPECT_NEAR(shone.x(), 0.2, 1e-6);
}

TEST_F(MeasuredHead, refuses_a_bad_file_naming_projector_file_position_and_remedy) {
  EXPECT_THAT(read(folder_ / "none.mpcdi").error().message(),
              AllOf(HasSubstr("projector 'middle'"), HasSubstr("none.mpcdi")));
  std::ofstream(folder_ / "bad.obj") << "v 0 0 0\nv 1 0 0\nv 1 1 3\n";
  EXPECT_THAT(read(folder_ / "bad.obj").error().message(),
              AllOf(HasSubstr("projector 'middle'"), HasSubstr("bad.obj"), HasSubstr("line 3"), HasSubstr("export")));
  ASSERT_TRUE(interchange::write_mpcdi(folder_ / "wall.mpcdi", interchange::set_of(room_)));
  EXPECT_THAT(read(folder_ / "wall.mpcdi", "floor").error().message(),
              AllOf(HasSubstr("wall.mpcdi"), HasSubstr("'left', 'middle', 'right'; name one")));
  room_.projectors[kMiddle].lens.width_px = 640;
  EXPECT_THAT(read(folder_ / "wall.mpcdi").error().message(),
              AllOf(HasSubstr("wall.mpcdi"), HasSubstr("320x240"), HasSubstr("640x240"), HasSubstr("width_px")));
}

}  // namespace
}  // namespace cyclorama::display

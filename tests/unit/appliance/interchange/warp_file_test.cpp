// SPDX-License-Identifier: Apache-2.0
#include "appliance/interchange/warp_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "appliance/interchange/warp_picture.h"
#include "tests/data_sets/generated_warps.h"

namespace cyclorama::interchange {
namespace {

using ::testing::HasSubstr;

constexpr double kHalfSample = 0.8e-2;  ///< At the rim of the mapped area a mesh takes the nearest sample.

class WarpFiles : public ::testing::Test {
 protected:
  WarpFiles() : folder_(std::filesystem::temp_directory_path() / ("warp_file_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
    options_.width_px = 64;
    options_.height_px = 40;
    WarpRegion region;
    region.id = "left";
    region.width_px = 64;
    region.height_px = 40;
    region.map = GeneratedWarps(4).map(64, 40, true);
    region.alpha = MaskMap(64, 40, 1, 16);
    for (std::uint16_t& sample : region.alpha->samples) sample = 40000;
    set_.buffers.push_back({"wall", 0, 0, {region}});
  }
  ~WarpFiles() override { std::filesystem::remove_all(folder_); }

  WarpSet set_;
  WarpFileOptions options_;
  std::filesystem::path folder_;
};

TEST_F(WarpFiles, every_format_survives_a_round_trip_approximately) {
  for (const char* const name : {"a.mpcdi", "a.pfm", "a.data", "a.obj"}) {
    const std::filesystem::path path = folder_ / name;
    const Status written = write_warp_file(path, {set_, {}, {}}, "", options_);
    ASSERT_TRUE(written.has_value()) << written.error().message();
    const auto file = read_warp_file(path, options_);
    ASSERT_TRUE(file.has_value()) << file.error().message();
    const WarpRegion& back = file->set.buffers[0].regions[0];
    const WarpRegion& truth = set_.buffers[0].regions[0];
    int compared = 0;
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 64; ++x) {
        if (std::isnan(back.map->at(x, y)[0]) || std::isnan(truth.map->at(x, y)[0])) continue;
        ++compared;
        for (int i = 0; i < 2; ++i) EXPECT_NEAR(back.map->at(x, y)[i], truth.map->at(x, y)[i], kHalfSample) << name;
      }
    }
    EXPECT_GT(compared, 64 * 40 * 9 / 10) << name;
    EXPECT_GT(mapped_fraction(back), 0.9) << name;
  }
}

TEST_F(WarpFiles, a_mesh_converted_to_its_own_format_is_the_same_text) {
  const auto text_of = [](const std::filesystem::path& path) {
    std::ifstream in(path);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  for (const std::string ending : {".data", ".obj"}) {
    ASSERT_TRUE(write_warp_file(folder_ / ("a" + ending), {set_, {}, {}}, "", options_).has_value());
    const auto first = read_warp_file(folder_ / ("a" + ending), options_);
    ASSERT_TRUE(first.has_value()) << first.error().message();
    ASSERT_TRUE(write_warp_file(folder_ / ("b" + ending), *first, "", options_).has_value());
    EXPECT_EQ(text_of(folder_ / ("a" + ending)), text_of(folder_ / ("b" + ending)));
    options_.grid = {9, 7};
    ASSERT_TRUE(write_warp_file(folder_ / ("c" + ending), *first, "", options_).has_value());
    EXPECT_EQ(read_warp_file(folder_ / ("c" + ending), options_)->mesh->nodes.size(), 63U);
    options_.grid.reset();
  }
  // A mesh of triangles is no grid, which a .data file needs.
  const auto triangles = read_warp_file(folder_ / "a.obj", options_);
  ASSERT_TRUE(write_warp_file(folder_ / "d.data", *triangles, "", options_).has_value());
  EXPECT_EQ(read_warp_file(folder_ / "d.data", options_)->mesh->columns, kDefaultGrid.columns);
}

TEST_F(WarpFiles, a_mesh_carries_the_mask_as_light_and_an_obj_has_a_separate_mask) {
  ASSERT_TRUE(write_warp_file(folder_ / "a.data", {set_, {}, {}}, "left", options_).has_value());
  const auto file = read_warp_file(folder_ / "a.data", options_);
  ASSERT_TRUE(file.has_value());
  EXPECT_NEAR(file->set.region("a")->alpha->light_at(40, 10), 40000.0 / 65535.0, 1e-4);
  ASSERT_TRUE(write_warp_file(folder_ / "b.obj", {set_, {}, {}}, "left", options_).has_value());
  EXPECT_TRUE(std::filesystem::exists(folder_ / "b.png"));
}

TEST_F(WarpFiles, refuses_what_does_not_fit_with_a_remedy) {
  const auto refusal = [](const Status& status) { return status ? "" : status.error().message(); };
  EXPECT_THAT(refusal(write_warp_file(folder_ / "a.csv", {set_, {}, {}}, "", options_)), HasSubstr("use .mpcdi"));
  EXPECT_THAT(refusal(write_warp_file(folder_ / "a.pfm", {set_, {}, {}}, "right", options_)), HasSubstr("'left'"));
  set_.profile = WarpProfile::kAdvanced3d;
  EXPECT_THAT(refusal(write_warp_file(folder_ / "a.obj", {set_, {}, {}}, "", options_)), HasSubstr("flat picture"));
  EXPECT_THAT(read_warp_file(folder_ / "a.jpg", options_).error().message(), HasSubstr(".simcad"));
  std::ofstream(folder_ / "far.data") << "2\n2 2\n9 9 0 0 1\n9.5 9 0 0 1\n9 9.5 0 0 1\n9.5 9.5 0 0 1\n";
  EXPECT_THAT(read_warp_file(folder_ / "far.data", options_).error().message(), HasSubstr("covers no pixel"));
}

TEST_F(WarpFiles, preview_shows_the_mapped_area_dimmed_by_the_mask) {
  const WarpRegion& region = set_.buffers[0].regions[0];
  const RgbImage picture = picture_of(region);
  EXPECT_EQ(picture.at(0, 39)[0], 0);
  EXPECT_EQ(picture.at(0, 39)[2], 64) << "not mapped";
  WarpRegion bright = region;
  bright.alpha.reset();
  EXPECT_GT(picture_of(bright).at(60, 5)[0], picture.at(60, 5)[0]);
  EXPECT_EQ(mapped_fraction(WarpRegion()), 0.0);
}

}  // namespace
}  // namespace cyclorama::interchange

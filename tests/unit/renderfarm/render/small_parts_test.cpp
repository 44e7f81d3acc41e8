// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "renderfarm/render/memory.h"
#include "renderfarm/render/requirements.h"
#include "renderfarm/render/sky.h"
#include "renderfarm/render/tone.h"
#include "tests/data_sets/simple_scenes.h"

namespace cyclorama::render {
namespace {

TEST(ToneMapped, keeps_the_lower_half_and_never_reaches_white) {
  for (const float x : {0.0f, 0.01f, 0.18f, 0.5f}) EXPECT_EQ(tone_mapped(x), x);
  float before = 0.5f;
  for (float x = 0.51f; x < 5.0f; x += 0.01f) {
    EXPECT_GT(tone_mapped(x), before);
    EXPECT_LE(tone_mapped(x), 1.0f);
    EXPECT_LE(tone_mapped(x) - before, 0.0101f);
    before = tone_mapped(x);
  }
  EXPECT_EQ(tone_mapped(std::numeric_limits<float>::infinity()), 1.0f);
}

TEST(ToneMapped, maps_negative_light_and_nan_to_black) {
  EXPECT_EQ(tone_mapped(-1.0f), 0.0f);
  EXPECT_EQ(tone_mapped(std::numeric_limits<float>::quiet_NaN()), 0.0f);
}

TEST(Sky, is_a_gradient_from_ground_over_horizon_to_zenith) {
  const scene::Sky sky{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  EXPECT_TRUE(sky_radiance(sky, {0, 1, 0}).isApprox(Vec3(1, 0, 0)));
  EXPECT_TRUE(sky_radiance(sky, {1, 0, 0}).isApprox(Vec3(0, 1, 0)));
  EXPECT_TRUE(sky_radiance(sky, {0, -1, 0}).isApprox(Vec3(0, 0, 1)));
  EXPECT_TRUE(sky_radiance(sky, {0.8660254f, 0.5f, 0}).isApprox(Vec3(0.5f, 0.5f, 0)));
}

class GroupedMemory : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::remove_all(root_); }
  void TearDown() override { std::filesystem::remove_all(root_); }
  void write(const std::string& path, const std::string& text) const {
    std::filesystem::create_directories((root_ / path).parent_path());
    std::ofstream(root_ / path) << text;
  }
  const std::filesystem::path root_ = std::filesystem::path(testing::TempDir()) / "grouped_memory";
};

TEST_F(GroupedMemory, is_what_the_tightest_group_has_left) {
  EXPECT_EQ(cgroup_memory(root_), std::nullopt);
  EXPECT_EQ(available_memory(root_), std::nullopt);
  write("proc/meminfo", "MemAvailable: 1000 kB\n");
  write("proc/self/cgroup", "12:cpu:/old\n0::/farm/node.service\n");
  write("sys/fs/cgroup/farm/node.service/memory.max", "max\n");
  write("sys/fs/cgroup/farm/node.service/memory.current", "70000\n");
  EXPECT_EQ(cgroup_memory(root_), std::nullopt) << "no limit";
  EXPECT_EQ(available_memory(root_), 1000u * 1024u);
  write("sys/fs/cgroup/farm/memory.max", "500000\n");
  write("sys/fs/cgroup/farm/memory.current", "300000\n");
  EXPECT_EQ(cgroup_memory(root_), 200000u) << "the parent's";
  write("sys/fs/cgroup/farm/memory.stat", "anon 100\ninactive_file 50000\nactive_file 9\n");
  EXPECT_EQ(cgroup_memory(root_), 250000u) << "file pages can be taken back";
  write("sys/fs/cgroup/farm/node.service/memory.max", "80000\n");
  EXPECT_EQ(available_memory(root_), 10000u);
  write("sys/fs/cgroup/farm/node.service/memory.current", "90000\n");
  EXPECT_EQ(available_memory(root_), 0u) << "beyond its limit";
  write("proc/meminfo", "MemAvailable: 5 kB\n");
  write("proc/self/cgroup", "0::/\n");
  EXPECT_EQ(available_memory(root_), 5u * 1024u);
}

TEST(Memory, is_read_from_the_line_of_available_memory) {
  EXPECT_EQ(parse_available_memory("MemTotal:  8 kB\nMemAvailable:     123 kB\nBuffers: 1 kB\n"), 123u * 1024u);
  EXPECT_EQ(parse_available_memory("MemTotal: 8 kB\n"), std::nullopt);
  EXPECT_EQ(parse_available_memory("MemAvailable:"), std::nullopt);
  EXPECT_EQ(parse_available_memory("MemAvailable: many kB"), std::nullopt);
  EXPECT_EQ(parse_available_memory("MemAvailable: -5 kB"), std::nullopt);
  EXPECT_EQ(parse_available_memory(""), std::nullopt);
  EXPECT_GT(available_memory().value_or(0), 0u);
}

TEST(Memory, refuses_a_scene_that_would_not_fit_with_its_name_and_need) {
  constexpr std::size_t kGigabyte = std::size_t{1} << 30;
  const auto fits = [](const RenderNeed& need, std::size_t available) {
    return choose_memory_mode("hall", need, available, std::nullopt).has_value();
  };
  EXPECT_TRUE(fits({1'000'000, 0, 0}, kGigabyte));
  const auto status = choose_memory_mode("hall", {60'000'000, 0, 300'000'000}, kGigabyte, std::nullopt);
  ASSERT_FALSE(status.has_value());
  EXPECT_EQ(status.error().code(), ErrorCode::kSystem);
  for (const char* const part : {"'hall'", "4.3 GB", "300.0 MB", "1.0 GB"}) {
    EXPECT_THAT(status.error().message(), testing::HasSubstr(part));
  }
  EXPECT_FALSE(fits({1, 0, 0}, 0));
  EXPECT_FALSE(fits({1, 1'000'000, 0}, std::size_t{500} << 20));
  EXPECT_FALSE(fits({1, 0, kGigabyte}, kGigabyte)) << "textures alone";
}

TEST(Memory, of_triangles_is_as_fast_as_fits_or_as_is_asked_for) {
  constexpr RenderNeed kNeed{1'000'000, 0, 0};
  const auto mode = [&](std::size_t megabytes, std::optional<MemoryMode> wanted) {
    return choose_memory_mode("hall", kNeed, megabytes * 1'000'000, wanted);
  };
  EXPECT_EQ(*mode(300, std::nullopt), MemoryMode::kFast);
  EXPECT_EQ(*mode(200, std::nullopt), MemoryMode::kMedium);
  EXPECT_EQ(*mode(170, std::nullopt), MemoryMode::kCompact);
  EXPECT_FALSE(mode(100, std::nullopt).has_value());
  EXPECT_EQ(*mode(300, MemoryMode::kCompact), MemoryMode::kCompact);
  EXPECT_FALSE(mode(200, MemoryMode::kFast).has_value()) << "no other is taken";
}

TEST(HighestSurfaceLevel, is_that_of_the_used_materials) {
  scene::Scene scene = scene_of(square_mesh(1.0f));
  EXPECT_EQ(describe(highest_surface_level(scene)), "matte surfaces");
  scene.model.materials[0].roughness = 0.5f;
  EXPECT_EQ(describe(highest_surface_level(scene)), "glossy surfaces");
  scene.model.materials.emplace_back();
  scene.model.materials[1].clearcoat = 1.0f;  // Nothing uses this material.
  EXPECT_EQ(highest_surface_level(scene), SurfaceLevel::kGlossy);
  add_mesh(scene, square_mesh(1.0f, 1));
  EXPECT_EQ(describe(highest_surface_level(scene)), "layered surfaces");
  scene.model.instances.clear();
  EXPECT_EQ(highest_surface_level(scene), SurfaceLevel::kMatte);
}

TEST(Blending, requires_a_transparent_surface) {
  scene::Scene scene = scene_of(square_mesh(1.0f));
  scene.model.textures.emplace_back();
  scene.model.textures[0].pixels = RgbaImage(2, 2, 255);
  scene::Material& material = scene.model.materials[0];
  material.base_colour_texture.texture = 0;
  material.alpha_mode = scene::AlphaMode::kBlend;
  const auto lets_light_through = [&] {
    return blends(material, scene.model.meshes[0], see_through_textures(scene.model));
  };
  EXPECT_FALSE(lets_light_through());
  scene.model.textures[0].pixels.at(1, 1)[3] = 100;
  EXPECT_TRUE(lets_light_through());
  material.alpha_mode = scene::AlphaMode::kMask;
  EXPECT_FALSE(lets_light_through());
}

}  // namespace
}  // namespace cyclorama::render

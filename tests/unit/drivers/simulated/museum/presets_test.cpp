// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/presets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "drivers/simulated/museum/simulated_museum.h"
#include "drivers/simulated/museum/true_museum.h"

namespace cyclorama::simulated {
namespace {

/// Returns a museum with few pixels and cells, which is fast enough for a test.
Result<Preset> small_preset(std::string_view name, std::uint32_t seed) {
  PresetOptions options;
  options.projector_width_px = 192;
  options.projector_height_px = 108;
  options.camera_megapixels = 0.03;
  auto preset = make_preset(name, seed, options);
  if (preset) preset->truth.cells = 40;
  return preset;
}

class Presets : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, Presets, ::testing::ValuesIn(preset_names()), [](const auto& kind) {
  std::string name = kind.param;
  std::erase(name, '-');
  return name;
});

TEST_P(Presets, are_valid_rooms_for_twenty_seeds) {
  std::vector<std::string> texts;
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const auto preset = small_preset(GetParam(), seed);
    ASSERT_TRUE(preset) << preset.error().message();
    const auto museum = TrueMuseum::make(preset->installation, preset->truth);
    ASSERT_TRUE(museum) << museum.error().message();
    texts.push_back(preset->truth.text());
    EXPECT_EQ(small_preset(GetParam(), seed)->truth.text(), texts.back());
    for (std::size_t i = 0; i + 1 < texts.size(); ++i) EXPECT_NE(texts[i], texts.back());
  }
}

// Without overlap no calibration could align the projectors.
TEST_P(Presets, light_most_of_the_wall_with_overlap) {
  for (std::uint32_t seed = 0; seed < 5; ++seed) {
    const Preset preset = *small_preset(GetParam(), seed);
    const TrueMuseum museum = *TrueMuseum::make(preset.installation, preset.truth);
    int lit = 0;
    int twice = 0;
    int positions = 0;
    std::vector<int> of_projector(preset.truth.projectors.size(), 0);
    for (std::size_t part = 0; part < museum.wall().part_count(); ++part) {
      for (double across = 0.0125; across < 1.0; across += 0.025) {
        for (double along = 0.0125; along < 1.0; along += 0.025) {
          const auto at = museum.wall().at({part, across, along});
          int count = 0;
          for (std::size_t i = 0; i < of_projector.size(); ++i) {
            const auto pixel = museum.projector_pixel(i, at);
            if (!pixel || !preset.truth.projectors[i].lens.pinhole().contains(*pixel)) continue;
            ++count;
            ++of_projector[i];
          }
          ++positions;
          lit += count > 0 ? 1 : 0;
          twice += count > 1 ? 1 : 0;
        }
      }
    }
    EXPECT_GT(lit, 0.85 * positions) << seed;
    EXPECT_GT(twice, 0.05 * positions) << seed;
    for (const int count : of_projector) EXPECT_GT(count, positions / 8) << seed;
  }
}

TEST_P(Presets, truth_survives_a_round_trip) {
  const Preset preset = *small_preset(GetParam(), 7);
  std::string folder = ::testing::TempDir() + "/preset.XXXXXX";
  ASSERT_NE(::mkdtemp(folder.data()), nullptr);
  ASSERT_TRUE(write_preset(preset, folder));
  const auto read = MuseumTruth::read(truth_path_beside(std::filesystem::path(folder) / "installation.toml"));
  ASSERT_TRUE(read) << read.error().message();
  // Angles are converted via degrees, and quaternions are normalised again, so the last digit may change.
  const TrueMuseum written = *TrueMuseum::make(preset.installation, preset.truth);
  const TrueMuseum again = *TrueMuseum::make(preset.installation, *read);
  for (std::size_t i = 0; i < preset.truth.projectors.size(); ++i) {
    for (double u = 5.0; u < 192.0; u += 31.0) {
      const auto a = written.wall_at(i, u, 50.0);
      const auto b = again.wall_at(i, u, 50.0);
      ASSERT_EQ(a.has_value(), b.has_value());
      if (!a) continue;
      EXPECT_LT((a->point.xyz - b->point.xyz).norm(), 1e-9);
      EXPECT_NEAR(written.gain_lux(i, *a), again.gain_lux(i, *b), 1e-6);
      EXPECT_EQ(written.colour_of(i, {10, 99, 200}), again.colour_of(i, {10, 99, 200}));
    }
  }
  EXPECT_LT((written.camera_pose(0.4).translation() - again.camera_pose(0.4).translation()).norm(), 1e-12);
  EXPECT_EQ(read->camera.bits, preset.truth.camera.bits);
  EXPECT_EQ(read->camera.lens.radial(), preset.truth.camera.lens.radial());
  EXPECT_EQ(read->seed, preset.truth.seed);
  auto museum = SimulatedMuseum::open(std::filesystem::path(folder) / "installation.toml", 1);
  ASSERT_TRUE(museum) << museum.error().message();
  EXPECT_TRUE(museum->photograph_grey(0.01));
  std::filesystem::remove_all(folder);
}

TEST(PresetWalls, the_uneven_cylinder_has_the_measured_radii) {
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    const Preset preset = *small_preset("not-quite-cylinder", seed);
    const TrueWall wall = *TrueWall::make(preset.truth.wall, preset.truth.T_room_wall, preset.truth.deviation);
    double min = 10.0;
    double max = 0.0;
    for (int i = 0; i <= 2000; ++i) {
      const Eigen::Vector3d point = wall.at({0, i / 2000.0, 0.5}).point.xyz;
      min = std::min(min, std::hypot(point.x(), point.z()));
      max = std::max(max, std::hypot(point.x(), point.z()));
    }
    EXPECT_NEAR(min, 4.06, 1e-4) << seed;
    EXPECT_NEAR(max, 4.6, 1e-4) << seed;
  }
}

TEST(PresetWalls, only_the_tilted_cylinder_leans) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const Preset leaning = *small_preset("tilted", seed);
    const Eigen::Vector3d axis = leaning.truth.T_room_wall.rotation() * Eigen::Vector3d::UnitY();
    const double degrees = std::acos(axis.y()) * 180.0 / 3.14159265358979;
    EXPECT_GE(degrees, 1.5);
    EXPECT_LE(degrees, 4.0);
    EXPECT_TRUE(small_preset("cylinder126", seed)->truth.deviation.is_flat());
  }
}

TEST(PresetWalls, refuses_an_unknown_preset_and_lists_the_known_ones) {
  const auto none = make_preset("pyramid", 1);
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message().find("cylinder126"), std::string::npos);
  PresetOptions options;
  options.overlap = 1.5;
  EXPECT_FALSE(make_preset("plane", 1, options));
}

TEST(MuseumTruth, names_the_line_of_a_mistake) {
  std::string text = small_preset("plane", 1)->truth.text();
  text.insert(text.find("bits = ") + 7, "9");  // 98 or 912.
  const auto wrong = MuseumTruth::parse(text, "it");
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().message().find("bits"), std::string::npos);
  EXPECT_FALSE(MuseumTruth::parse("unheard = 1\n", "it"));
}

}  // namespace
}  // namespace cyclorama::simulated

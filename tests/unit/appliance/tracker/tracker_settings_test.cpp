// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/tracker_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "common/wand/folded_card.h"

namespace cyclorama {
namespace {

using testing::HasSubstr;

std::string mistake_in(const std::string& text) {
  const auto settings = TrackerSettings::parse(text, "tracker.toml");
  EXPECT_FALSE(settings.has_value()) << text;
  return settings ? "" : settings.error().message();
}

TEST(TrackerSettings, has_the_demo_s_values_when_nothing_is_said) {
  const auto settings = TrackerSettings::parse("", "tracker.toml");
  ASSERT_TRUE(settings.has_value());
  const TrackerSettings defaults;
  EXPECT_EQ(settings->camera, defaults.camera);
  EXPECT_FALSE(settings->tracking.patterns.flat_tag_size_m.has_value());
  EXPECT_EQ(settings->detector.decimate, defaults.detector.decimate);
  EXPECT_NEAR(settings->lens.field_of_view_rad, defaults.lens.field_of_view_rad, 1e-12);
}

TEST(TrackerSettings, reads_every_key) {
  const auto settings = TrackerSettings::parse(R"(
    tour = "[::1]:1"
    listen = "[::1]:2"
    [camera]
    source = "file:photos"
    name = "left"
    focal_px = 700
    centre_px = [310, 250]
    [tag]
    family = "tag25h9"
    size_mm = 90
    id = 3
    [detector]
    decimate = 2.5
    threads = 2
    tiles = false
    refine_edges = false
    refine_corners = false
    most_hamming = 1
    least_margin_grey = 33
    [filter]
    position_cutoff_hz = 3
    position_cutoff_hz_per_m_s = 4
    rotation_cutoff_hz = 5
    rotation_cutoff_hz_per_rad_s = 6
    corner_floor_px = 0.3
    memory_s = 2
  )",
                                               "tracker.toml");
  ASSERT_TRUE(settings.has_value()) << settings.error().message();
  EXPECT_EQ(settings->camera, "file:photos");
  EXPECT_EQ(settings->name, "left");
  EXPECT_EQ(settings->detector.family, "tag25h9");
  EXPECT_EQ(settings->tracking.patterns.flat_tag_size_m, 0.09);
  EXPECT_EQ(settings->tracking.patterns.only, 3);
  EXPECT_EQ(settings->detector.decimate, 2.5);
  EXPECT_EQ(settings->detector.threads, 2);
  EXPECT_FALSE(settings->detector.tiles);
  EXPECT_FALSE(settings->detector.refine_edges);
  EXPECT_FALSE(settings->detector.refine_corners);
  EXPECT_EQ(settings->detector.most_hamming, 1);
  EXPECT_EQ(settings->detector.least_margin, 33.0);
  EXPECT_EQ(settings->tracking.position.least_cutoff_hz, 3.0);
  EXPECT_EQ(settings->tracking.position.cutoff_per_speed, 4.0);
  EXPECT_EQ(settings->tracking.rotation.least_cutoff_hz, 5.0);
  EXPECT_EQ(settings->tracking.rotation.cutoff_per_speed, 6.0);
  EXPECT_EQ(settings->tracking.corner_floor_px, 0.3);
  EXPECT_EQ(settings->tracking.chooser.memory_s, 2.0);
  EXPECT_EQ(settings->tour, "[::1]:1");
  EXPECT_EQ(settings->listen, "[::1]:2");
  const Pinhole lens = lens_for(settings->lens, 640, 480);
  EXPECT_EQ(lens.focal_px, 700.0);
  EXPECT_EQ(lens.centre_u_px, 310.0);
  EXPECT_EQ(lens.centre_v_px, 250.0);
}

TEST(TrackerSettings, reads_which_wands_visitors_hold) {
  EXPECT_EQ(TrackerSettings::parse("[wand]\nnumber = 4\n", "t")->tracking.patterns.only, 4);
  const std::filesystem::path folder = testing::TempDir();
  std::ofstream(folder / "blue.toml") << wand_toml(standard_wand(9));
  std::ofstream(folder / "tracker.toml") << "[wand]\nfiles = [\"blue.toml\"]\n";
  const auto settings = TrackerSettings::read(folder / "tracker.toml");
  ASSERT_TRUE(settings.has_value()) << settings.error().message();
  ASSERT_EQ(settings->tracking.patterns.wands.size(), 1U);
  EXPECT_EQ(settings->tracking.patterns.wands[0].id(), 27);
  EXPECT_THAT(mistake_in("[wand]\nfiles = [\"no-such-file.toml\"]\n"), HasSubstr("no-such-file.toml"));
  EXPECT_THAT(mistake_in("[wand]\nnumber = 1\nfiles = [\"no-such-file.toml\"]\n"), HasSubstr("tracker.toml:2:"));
  EXPECT_THAT(mistake_in("[tag]\nid = 1\n[wand]\nnumber = 1\n"), HasSubstr("remove one"));
}

TEST(TrackerSettings, names_the_line_of_a_mistake) {
  EXPECT_THAT(mistake_in("[tag]\nsize_cm = 12\n"), HasSubstr("tracker.toml:2:"));
  EXPECT_THAT(mistake_in("[tag]\n\nsize_mm = -1\n"), HasSubstr("tracker.toml:3:"));
  EXPECT_THAT(mistake_in("[tag]\nfamily = \"aruco\"\n"), HasSubstr("tracker.toml:2:"));
  EXPECT_THAT(mistake_in("[detector]\ndecimate = 0\n"), HasSubstr("tracker.toml:2:"));
  EXPECT_THAT(mistake_in("[filter]\nposition_cutoff_hz = nan\n"), HasSubstr("tracker.toml:2:"));
  EXPECT_THAT(mistake_in("[camera]\nfield_of_view_deg = 60\nfocal_px = 500\n"), HasSubstr("say the same"));
  EXPECT_THAT(mistake_in("[lens]\n"), HasSubstr("tracker.toml:1:"));
}

}  // namespace
}  // namespace cyclorama

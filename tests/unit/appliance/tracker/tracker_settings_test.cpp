// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/tracker_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "appliance/calibration/camera_file.h"
#include "common/wand/folded_card.h"

namespace cyclorama::tracker {
namespace {

using testing::HasSubstr;

std::string mistake_in(const std::string& text) {
  const auto settings = TrackerSettings::parse(text, "tracker.toml");
  EXPECT_FALSE(settings.has_value()) << text;
  return settings ? "" : settings.error().message();
}

TEST(TrackerSettings, has_the_demos_values_by_default) {
  const auto settings = TrackerSettings::parse("", "tracker.toml");
  ASSERT_TRUE(settings.has_value());
  const TrackerSettings defaults;
  EXPECT_EQ(settings->camera, defaults.camera);
  EXPECT_FALSE(settings->tracking.patterns.flat_tag_size_m.has_value());
  EXPECT_EQ(settings->detector.decimate, defaults.detector.decimate);
  EXPECT_NEAR(settings->lens.field_of_view_rad, defaults.lens.field_of_view_rad, 1e-12);
}

TEST(TrackerSettings, uses_a_calibrated_lens) {
  const auto folder = std::filesystem::temp_directory_path() / ("tracker-lens-" + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  calibration::CameraFile camera{"a camera",
                                 "2026-01-01T00-00-00Z",
                                 calibration::MeasuredLens::from_focal(1280, 960, 1100.0),
                                 calibration::LensModel::kRadial1,
                                 12,
                                 0.1,
                                 0.1};
  camera.lens.values[calibration::MeasuredLens::kK1] = -0.1;
  std::ofstream(folder / "camera.json") << calibration::camera_json(camera);
  std::ofstream(folder / "tracker.toml") << "[camera]\nlens = \"camera.json\"\n";
  const auto settings = TrackerSettings::read(folder / "tracker.toml");
  std::ofstream(folder / "tracker.toml") << "[camera]\nlens = \"other.json\"\n";
  const auto missing = TrackerSettings::read(folder / "tracker.toml");
  std::filesystem::remove_all(folder);
  ASSERT_TRUE(settings) << settings.error().message();
  ASSERT_TRUE(settings->lens.calibrated);
  EXPECT_EQ(lens_for(settings->lens, 640, 480).focal_px, 550.0);
  // The aspect ratio differs: the default field of view is used.
  EXPECT_NEAR(lens_for(settings->lens, 640, 360).focal_px, lens_for({}, 640, 360).focal_px, 1e-9);
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message(), HasSubstr("other.json"));
  EXPECT_THAT(mistake_in("[camera]\nlens = \"camera.json\"\nfocal_px = 700\n"), HasSubstr("focal_px"));
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
    max_hamming = 1
    min_margin_grey = 33
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
  EXPECT_EQ(settings->detector.max_hamming, 1);
  EXPECT_EQ(settings->detector.min_margin, 33.0);
  EXPECT_EQ(settings->tracking.position.min_cutoff_hz, 3.0);
  EXPECT_EQ(settings->tracking.position.cutoff_per_speed, 4.0);
  EXPECT_EQ(settings->tracking.rotation.min_cutoff_hz, 5.0);
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

TEST(TrackerSettings, reads_the_visitors_wands) {
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

TEST(TrackerSettings, reads_the_way_of_steering) {
  const auto wand = TrackerSettings::parse("", "tracker.toml");
  ASSERT_TRUE(wand.has_value());
  EXPECT_EQ(wand->steer_by, SteerBy::kWand);
  const auto body = TrackerSettings::parse(R"(
    steer_by = "body"
    [body]
    mark_distance_m = 2.5
    follow_radius_m = 1.1
    begin_within_m = 0.4
    cells_across = 200
  )",
                                           "tracker.toml");
  ASSERT_TRUE(body.has_value()) << body.error().message();
  EXPECT_EQ(body->steer_by, SteerBy::kBody);
  EXPECT_EQ(body->body.mark_distance_m, 2.5);
  EXPECT_EQ(body->body.follow_radius_m, 1.1);
  EXPECT_EQ(body->body.begin_within_m, 0.4);
  EXPECT_EQ(body->background.cells_across, 200);
  EXPECT_THAT(mistake_in("steer_by = \"mind\"\n"), HasSubstr("tracker.toml:1"));
  EXPECT_THAT(mistake_in("[body]\nstand_m = 0\n"), HasSubstr("tracker.toml:2"));
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

TEST(TrackerSettings, names_a_real_camera_by_its_port_or_path) {
  const auto camera_of = [](const std::string& lines) {
    const auto settings = TrackerSettings::parse("[camera]\n" + lines, "tracker.toml");
    return settings ? settings->camera : settings.error().message();
  };
  EXPECT_EQ(camera_of("kind = 'v4l2'"), "v4l2:");
  EXPECT_EQ(camera_of("kind = 'v4l2'\nport = 'usb-0000:00:14.0-2'"), "v4l2:usb-0000:00:14.0-2");
  EXPECT_EQ(camera_of("kind = 'libcamera'\nport = '/base/soc/i2c0/imx219@10'"), "libcamera:/base/soc/i2c0/imx219@10");
  EXPECT_EQ(camera_of("kind = 'v4l2'\ndevice = '/dev/video3'\nwidth_px = 1280\nheight_px = 720\n"
                      "frames_per_second = 59.94\nexposure_ms = 2.5\nmemory = 'dma_buf'"),
            "v4l2:/dev/video3?width_px=1280&height_px=720&frames_per_second=59.94&exposure_ms=2.5&memory=dma_buf");
}

TEST(TrackerSettings, refuses_a_camera_that_is_named_twice_or_not_at_all) {
  EXPECT_THAT(mistake_in("[camera]\nkind = 'v4l2'\nsource = 'simulated'"), HasSubstr("remove one"));
  EXPECT_THAT(mistake_in("[camera]\nkind = 'v4l2'\nport = 'a'\ndevice = '/b'"), HasSubstr("remove one"));
  EXPECT_THAT(mistake_in("[camera]\nport = 'a'"), HasSubstr("needs kind"));
  EXPECT_THAT(mistake_in("[camera]\nexposure_ms = 3"), HasSubstr("needs kind"));
  EXPECT_THAT(mistake_in("[camera]\nkind = 'webcam'"), HasSubstr("v4l2"));
  EXPECT_THAT(mistake_in("[camera]\nkind = 'v4l2'\nport = 'a?width_px=3'"), HasSubstr("no port does"));
  EXPECT_THAT(mistake_in("[camera]\nkind = 'v4l2'\ndevice = 'video0'"), HasSubstr("must be a path"));
  EXPECT_THAT(mistake_in("[camera]\nkind = 'v4l2'\nport = '/dev/video0'"), HasSubstr("write device"));
  EXPECT_THAT(mistake_in("[camera]\nkind = 'v4l2'\nframes_per_second = 0"), HasSubstr("frames_per_second"));
  EXPECT_THAT(mistake_in("[camera]\nkind = 'libcamera'\nmemory = 'dma_buf'"), HasSubstr("v4l2"));
}

}  // namespace
}  // namespace cyclorama::tracker

// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibrator/calibrator_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "appliance/calibration/camera_file.h"
#include "common/base/file.h"

namespace cyclorama::calibrator {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr double kDegree = std::numbers::pi / 180.0;

std::string mistake_in(const std::string& text) {
  const auto settings = CalibratorSettings::parse(text, "calibrator.toml");
  return settings ? "no mistake" : settings.error().message();
}

TEST(CalibratorSettings, have_defaults_for_an_empty_file) {
  const auto settings = CalibratorSettings::parse("", "calibrator.toml");
  ASSERT_TRUE(settings) << settings.error().message();
  const CalibratorSettings defaults;
  EXPECT_EQ(settings->listen, defaults.listen);
  EXPECT_THAT(settings->displays, IsEmpty());
  EXPECT_EQ(settings->turntable, "manual");
  EXPECT_EQ(settings->camera, "v4l2:");
  EXPECT_TRUE(settings->lens.empty());
  EXPECT_THAT(settings->watch, IsEmpty());
  for (double CalibratorSettings::*number :
       {&CalibratorSettings::settle_s, &CalibratorSettings::field_of_view_rad, &CalibratorSettings::pitch_rad,
        &CalibratorSettings::max_exposure_s, &CalibratorSettings::watch_exposure_s, &CalibratorSettings::watch_hz,
        &CalibratorSettings::latency_s}) {
    EXPECT_NEAR((*settings).*number, defaults.*number, 1e-12);
  }
}

TEST(CalibratorSettings, reads_every_key) {
  const auto settings = CalibratorSettings::parse(R"(
    listen = "[::1]:1"
    displays = ["left,middle=[::1]:7404", "right=museum-2:7404"]
    turntable = "serial:/dev/serial/by-id/usb-x?baud=250000&axis=A&units_per_turn=-1600"
    settle_ms = 150
    [camera]
    kind = "v4l2"
    port = "usb-0000:00:14.0-2"
    width_px = 2560
    lens = "camera.json"
    pitch_deg = -5
    max_exposure_ms = 500
    [watch]
    exposure_ms = 20
    compare_hz = 2
    latency_ms = 45
    [[watch.camera]]
    name = "left"
    kind = "v4l2"
    port = "usb-0000:00:14.0-3"
    [[watch.camera]]
    name = "right_2"
    kind = "libcamera"
    port = "/base/soc/i2c0mux"
    height_px = 1080
  )",
                                                  "calibrator.toml");
  ASSERT_TRUE(settings) << settings.error().message();
  EXPECT_EQ(settings->listen, "[::1]:1");
  ASSERT_THAT(settings->displays, SizeIs(2));
  EXPECT_THAT(settings->displays[0].projectors, ElementsAre("left", "middle"));
  EXPECT_EQ(settings->displays[1].address, "museum-2:7404");
  EXPECT_EQ(settings->turntable, "serial:/dev/serial/by-id/usb-x?baud=250000&axis=A&units_per_turn=-1600");
  EXPECT_NEAR(settings->settle_s, 0.15, 1e-12);
  EXPECT_EQ(settings->camera, "v4l2:usb-0000:00:14.0-2?width_px=2560");
  EXPECT_EQ(settings->lens, "camera.json");
  EXPECT_NEAR(settings->pitch_rad, -5 * kDegree, 1e-12);
  EXPECT_NEAR(settings->max_exposure_s, 0.5, 1e-12);
  EXPECT_NEAR(settings->watch_exposure_s, 0.02, 1e-12);
  EXPECT_EQ(settings->watch_hz, 2.0);
  EXPECT_NEAR(settings->latency_s, 0.045, 1e-12);
  ASSERT_THAT(settings->watch, SizeIs(2));
  EXPECT_EQ(settings->watch[0].name, "left");
  EXPECT_EQ(settings->watch[0].spec, "v4l2:usb-0000:00:14.0-3");
  EXPECT_EQ(settings->watch[1].spec, "libcamera:/base/soc/i2c0mux?height_px=1080");
}

TEST(CalibratorSettings, names_the_line_of_a_mistake_and_the_remedy) {
  struct Case {
    const char* text;
    const char* line;
    const char* says;
  };
  const std::string left = "[[watch.camera]]\nname = \"left\"\nkind = \"v4l2\"\nport = \"usb-1\"\n";
  const std::string twice = left + "[[watch.camera]]\nname = \"left\"\nkind = \"v4l2\"\nport = \"usb-2\"\n";
  const std::string one_port = left + "[[watch.camera]]\nname = \"right\"\nkind = \"v4l2\"\nport = \"usb-1\"\n";
  const Case cases[] = {
      {"listen = \"here\"\n", "calibrator.toml:1", "here"},
      {"\ndisplays = [\"left\"]\n", "calibrator.toml:2", "left"},
      {"displays = [\"=[::1]:7404\"]\n", "calibrator.toml:1", "write left,middle=HOST:PORT"},
      {"\nturnplate = \"manual\"\n", "calibrator.toml:2", "is called 'turntable' now"},
      {"turntable = \"lazy-susan\"\n", "calibrator.toml:1", "the kinds are serial:DEVICE and manual"},
      {"turntable = \"serial:/dev/ttyUSB0?most_deg=90\"\n", "calibrator.toml:1", "'most_deg' is now called 'max_deg'"},
      {"turntable = \"serial:/dev/ttyUSB0?speed=1\"\n", "calibrator.toml:1", "the options are baud"},
      {"turntable = \"serial:/dev/ttyUSB0?min_deg=10\"\n", "calibrator.toml:1", "range holds 0"},
      {"settle_ms = -1\n", "calibrator.toml:1", "settle_ms"},
      {"settle_s = 1\n", "calibrator.toml:1", "settle_s"},
      {"[camera]\nkind = \"film\"\n", "calibrator.toml:2", "v4l2"},
      {"[camera]\nport = \"usb-1\"\n", "calibrator.toml:2", "needs kind"},
      {"[camera]\nkind = \"v4l2\"\nexposure_ms = 5\n", "calibrator.toml:3", "chooses the exposure"},
      {"[camera]\nsource = \"webcam\"\n", "calibrator.toml:2", "names no camera"},
      {"[camera]\nfield_of_view_deg = 4\n", "calibrator.toml:2", "field_of_view_deg"},
      {"[camera]\nlens = \"camera.json\"\nfield_of_view_deg = 70\n", "calibrator.toml:3", "say the same"},
      {"[camera]\npitch_deg = nan\n", "calibrator.toml:2", "pitch_deg"},
      {"[camera]\nlongest_exposure_ms = 9000\n", "calibrator.toml:2", "max_exposure_ms"},
      {"[watch]\ncompare_hz = 11\n", "calibrator.toml:2", "compare_hz"},
      {"[watch]\nexposure_ms = 0\n", "calibrator.toml:2", "exposure_ms"},
      {"[watch]\nlatency_ms = \"30\"\n", "calibrator.toml:2", "latency_ms"},
      {"[watch]\ncameras = [\"left\"]\n", "calibrator.toml:2", "cameras"},
      {"[[watch.camera]]\nkind = \"v4l2\"\n", "calibrator.toml:1", "name"},
      {"[[watch.camera]]\nname = \"left\"\n", "calibrator.toml:1", "write kind"},
      {"[[watch.camera]]\nname = \"../left\"\nkind = \"v4l2\"\n", "calibrator.toml:2", "no name of a file"},
      {"[[watch.camera]]\nname = \"\"\nkind = \"v4l2\"\n", "calibrator.toml:2", "no name of a file"},
      {twice.c_str(), "calibrator.toml:6", "another camera's"},
      {one_port.c_str(), "calibrator.toml:8", "that of camera 'left'"},
      {"[camara]\n", "calibrator.toml:1", "camara"},
      {"[camera", "calibrator.toml:1", "calibrator.toml"},
  };
  for (const Case& c : cases) {
    EXPECT_THAT(mistake_in(c.text), HasSubstr(c.line)) << c.text;
    EXPECT_THAT(mistake_in(c.text), HasSubstr(c.says)) << c.text;
  }
}

TEST(CalibratorSettings, look_for_lenses_beside_the_file) {
  std::string name = (std::filesystem::temp_directory_path() / "calibrator-settings-XXXXXX").string();
  ASSERT_NE(::mkdtemp(name.data()), nullptr);
  const std::filesystem::path folder = name;
  const auto write = [&](const char* file, const std::string& text) {
    EXPECT_TRUE(write_file_atomically(folder / file, std::string_view(text)));
  };
  write("calibrator.toml",
        "[camera]\nlens = \"camera.json\"\n[[watch.camera]]\nname = \"left\"\nkind = \"v4l2\"\nport = \"usb-1\"\n");
  const auto settings = CalibratorSettings::read(folder / "calibrator.toml");
  ASSERT_TRUE(settings) << settings.error().message();
  EXPECT_EQ(settings->lens, folder / "camera.json");
  EXPECT_EQ(settings->lenses, folder / "cameras");
  const auto missing = settings->check_lenses();
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message(), HasSubstr("the camera on the turntable"));
  const calibration::CameraFile good{"a camera",
                                     "2026-01-01T00-00-00Z",
                                     calibration::MeasuredLens::from_focal(1280, 960, 1100.0),
                                     calibration::LensModel::kPinhole,
                                     12,
                                     0.1,
                                     0.1};
  write("camera.json", calibration::camera_json(good));
  EXPECT_TRUE(settings->check_lenses()) << "a fixed camera may have none yet";
  std::filesystem::create_directory(folder / "cameras");
  write("cameras/left.json", "{}");
  const auto damaged = settings->check_lenses();
  ASSERT_FALSE(damaged);
  EXPECT_THAT(damaged.error().message(), HasSubstr("camera 'left'"));
  EXPECT_THAT(damaged.error().message(), HasSubstr("left.json"));
  write("cameras/left.json", calibration::camera_json(good));
  EXPECT_TRUE(settings->check_lenses());
  std::filesystem::remove_all(folder);
}

TEST(CameraSource, has_a_name_and_a_device_line) {
  const auto plug = scan::parse_camera_source("left=v4l2:usb-1?width_px=640");
  ASSERT_TRUE(plug);
  EXPECT_EQ(plug->name, "left");
  EXPECT_EQ(plug->spec, "v4l2:usb-1?width_px=640");
  for (const char* bad : {"", "left", "left=", "=v4l2:", "a/b=v4l2:", ".left=v4l2:", "-left=v4l2:", "l r=v4l2:"})
    EXPECT_FALSE(scan::parse_camera_source(bad)) << bad;
}

}  // namespace
}  // namespace cyclorama::calibrator

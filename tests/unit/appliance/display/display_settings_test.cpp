// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/display_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "appliance/display/attract_picture.h"
#include "common/image/jpeg.h"

namespace cyclorama::display {
namespace {

using ::testing::HasSubstr;

TEST(DisplaySettings, are_read_from_the_same_file_as_the_tours) {
  const auto settings = parse_display_settings(R"(
[farm]
coordinators = ["[::1]:7401"]
[display]
attract_picture = "attract.jpg"
attract_after_s = 3
attract_fade_s = 0.5
picture_width_px = 4800
picture_height_px = 1080
refresh_hz = 59.94
[walk]
guide_after_s = 45
[hours]
open = ["Mon closed"]
)",
                                               "site.toml");
  ASSERT_TRUE(settings) << settings.error().message();
  EXPECT_EQ(settings->attract_picture, "attract.jpg");
  EXPECT_EQ(settings->attract_times.after, std::chrono::seconds(3));
  EXPECT_EQ(settings->attract_times.fade, std::chrono::milliseconds(500));
  EXPECT_EQ(settings->picture_width_px, 4800);
  EXPECT_EQ(settings->picture_height_px, 1080);
  EXPECT_EQ(settings->refresh_hz, 59.94);
  EXPECT_FALSE(settings->hours.is_open(WallTime(std::chrono::hours(24 * 365 * 57))));
}

TEST(DisplaySettings, have_defaults) {
  const auto settings = parse_display_settings("", "site.toml");
  ASSERT_TRUE(settings);
  EXPECT_TRUE(settings->attract_picture.empty());
  EXPECT_EQ(settings->attract_times.after, AttractTimes{}.after);
  EXPECT_EQ(settings->picture_width_px, 1024);
  EXPECT_EQ(settings->picture_height_px, 0);
  EXPECT_FALSE(settings->refresh_hz);
  EXPECT_TRUE(settings->hours.is_open(WallTime(std::chrono::hours(24 * 365 * 57))));
}

TEST(DisplaySettings, refuse_unknown_keys_by_line) {
  const auto refused = [](const std::string& text) {
    const auto settings = parse_display_settings(text, "site.toml");
    return settings ? std::string("taken") : settings.error().message();
  };
  EXPECT_THAT(refused("[display]\nattract_after_ms = 3\n"), HasSubstr("site.toml:2"));
  EXPECT_THAT(refused("[display]\nattract_after_s = -1\n"), HasSubstr("between"));
  EXPECT_THAT(refused("[display]\nattract_fade_s = 0\n"), HasSubstr("between"));
  EXPECT_THAT(refused("[display]\npicture_width_px = 15\n"), HasSubstr("site.toml:2"));
  EXPECT_THAT(refused("[display]\npicture_width_px = 1e9\n"), HasSubstr("site.toml:2"));
  EXPECT_THAT(refused("[display]\nrefresh_hz = 0\n"), HasSubstr("between"));
  EXPECT_THAT(refused("[display]\nattract_picture = 7\n"), HasSubstr("site.toml:2"));
  EXPECT_THAT(refused("[displays]\n"), HasSubstr("display"));
  EXPECT_THAT(refused("[hours]\nopen = [\"always\"]\n"), HasSubstr("site.toml:2: hours.open"));
}

TEST(AttractPicture, spans_the_wall_of_a_museum) {
  const std::filesystem::path path = std::filesystem::path(::testing::TempDir()) / "attract.jpg";
  const auto jpeg = JpegEncoder().encode(RgbImage(320, 100, 90), {.quality = 95});
  ASSERT_TRUE(jpeg);
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(jpeg->data()), static_cast<std::streamsize>(jpeg->size()));
  const Panorama wall{1024, 400, 2.2, 0.4, -0.3};
  const auto frame = attract_frame(wall, path);
  ASSERT_TRUE(frame) << frame.error().message();
  EXPECT_EQ(frame->shape, PictureShape(Panorama{320, 100, 2.2, 0.4, -0.3}));
  EXPECT_NEAR(*frame->picture->luma().at(100, 50), 90, 1);
  EXPECT_EQ(attract_frame(wall, path.parent_path() / "none.jpg").error().code(), ErrorCode::kNotFound);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace cyclorama::display

// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/mode_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/doubles/fake_card/fake_machine.h"

namespace cyclorama::output {
namespace {

using ::testing::ElementsAre;

std::vector<std::string> texts(std::vector<drmModeModeInfo> offered, ModePreference preferred) {
  std::vector<std::string> texts;
  for (const drmModeModeInfo& mode : modes_to_try(offered, preferred)) texts.push_back(text_of(mode));
  return texts;
}
std::string best(std::vector<drmModeModeInfo> offered, ModePreference preferred) {
  return texts(std::move(offered), preferred).front();
}

TEST(ModeChoice, takes_the_requested_size_at_the_nearest_rate) {
  const std::vector<drmModeModeInfo> offered{fake_mode(3840, 2160, 60.0, true), fake_mode(1920, 1200, 50.0),
                                             fake_mode(1920, 1200, 60.0), fake_mode(1920, 1080, 60.0)};
  EXPECT_EQ(best(offered, {1920, 1200, 60.0}), "1920x1200@60.00");
  EXPECT_EQ(best(offered, {1920, 1200, 48.0}), "1920x1200@50.00");
}

TEST(ModeChoice, falls_back_to_the_preferred_then_the_largest_then_a_common_mode) {
  const std::vector<drmModeModeInfo> offered{fake_mode(800, 600, 60.0), fake_mode(1600, 1200, 60.0),
                                             fake_mode(1280, 800, 60.0, true)};
  EXPECT_THAT(texts(offered, {1920, 1200, 60.0}),
              ElementsAre("1280x800@60.00", "1600x1200@60.00", "800x600@60.00", "1024x768@60.00"));
}

TEST(ModeChoice, tries_every_size_down_to_the_smallest) {
  std::vector<drmModeModeInfo> offered{fake_mode(640, 480, 60.0)};
  for (const int width : {3840, 2560, 1920, 1600, 1440, 1366, 1280, 1152, 800}) {
    for (const double hz : {24.0, 30.0, 60.0}) offered.push_back(fake_mode(width, 600, hz));
  }
  const auto tried = texts(offered, {2560, 600, 30.0});
  EXPECT_THAT(std::vector(tried.begin(), tried.begin() + 4),
              ElementsAre("2560x600@30.00", "2560x600@24.00", "2560x600@60.00", "3840x600@30.00"));
  EXPECT_EQ(tried.size(), 13U);
  EXPECT_EQ(tried[11], "640x480@60.00");
}

TEST(ModeChoice, takes_a_common_mode_when_none_is_listed) {
  EXPECT_THAT(texts({}, {1920, 1200, 60.0}), ElementsAre("1024x768@60.00"));
}

TEST(ModeChoice, leaves_out_stereo_and_invalid_modes_and_takes_interlaced_ones_last) {
  drmModeModeInfo interlaced = fake_mode(1920, 1080, 60.0, true);
  interlaced.flags |= DRM_MODE_FLAG_INTERLACE;
  drmModeModeInfo stereo = fake_mode(1920, 1080, 60.0);
  stereo.flags |= DRM_MODE_FLAG_3D_TOP_AND_BOTTOM;
  drmModeModeInfo impossible{};
  impossible.hdisplay = impossible.vdisplay = 1;
  EXPECT_THAT(texts({interlaced, stereo, impossible, fake_mode(640, 480, 60.0)}, {1920, 1080, 60.0}),
              ElementsAre("640x480@60.00", "1920x1080@60.00", "1024x768@60.00"));
}

TEST(ModeChoice, accepts_59_94_for_60_hz_and_prefers_the_projectors_own_timing) {
  drmModeModeInfo broadcast = fake_mode(1920, 1080, 59.94, true);
  EXPECT_EQ(best({fake_mode(1920, 1080, 60.0), broadcast}, {1920, 1080, 60.0}), "1920x1080@59.94");
}

TEST(ModeChoice, returns_few_modes_without_duplicates) {
  std::vector<drmModeModeInfo> offered;
  for (int n = 0; n < 100; ++n) offered.push_back(fake_mode(640 + 8 * (n / 2), 480, 60.0));
  const auto modes = modes_to_try(offered, {1920, 1080, 60.0});
  EXPECT_EQ(modes.size(), 32U);
  for (std::size_t i = 0; i < modes.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(is_same_mode(modes[i], modes[j]));
  }
  EXPECT_EQ(text_of(modes.back()), "1024x768@60.00");
}

}  // namespace
}  // namespace cyclorama::output

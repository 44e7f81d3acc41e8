// SPDX-License-Identifier: Apache-2.0
#include "kiosk/update/update_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cyclorama::update {
namespace {

using testing::HasSubstr;

/// Returns a time on 24 November 2026, a Tuesday, in Zurich (an hour ahead of UTC).
WallTime at(int hour, int minute = 0) {
  return absl::ToChronoTime(absl::FromCivil(absl::CivilMinute(2026, 11, 24, hour, minute), absl::FixedTimeZone(3600)));
}
constexpr const char* kZurich = "[hours]\nopen = [\"Mon-Sun 10:00-03:00\"]\ntime_zone = \"Europe/Zurich\"\n";

UpdateSettings settings(const std::string& text) {
  auto read = parse_update_settings(text, "site.toml");
  EXPECT_TRUE(read) << read.error().message();
  return *std::move(read);
}

TEST(UpdateSettings, wait_for_the_night_and_for_the_last_visitor) {
  const UpdateSettings usual = settings(kZurich);
  EXPECT_TRUE(usual.from_farm);
  EXPECT_FALSE(usual.is_night(at(1, 59)));
  EXPECT_FALSE(usual.is_night(at(2, 30))) << "the museum is open until three";
  EXPECT_TRUE(usual.is_night(at(3)));
  EXPECT_TRUE(usual.is_night(at(4, 59)));
  EXPECT_FALSE(usual.is_night(at(5)));
}

TEST(UpdateSettings, can_be_set_by_the_museum) {
  const UpdateSettings chosen =
      settings(std::string("[update]\nfrom_farm = false\nhours = \"23:00-09:00\"\n") + kZurich);
  EXPECT_FALSE(chosen.from_farm);
  EXPECT_FALSE(chosen.is_night(at(23, 30))) << "open";
  EXPECT_TRUE(chosen.is_night(at(8, 59)));
}

TEST(UpdateSettings, depend_on_the_night_alone_in_a_museum_that_is_always_open) {
  const UpdateSettings always = settings("[update]\nhours = \"00:00-24:00\"\n");
  EXPECT_TRUE(always.is_night(at(12)));
}

TEST(UpdateSettings, wait_for_the_end_of_an_override_that_keeps_the_museum_open) {
  for (const std::string& hours : {std::string(kZurich), std::string()}) {
    const UpdateSettings usual = settings(hours);
    const HoursOverride open{true, at(3), at(4)};
    EXPECT_FALSE(usual.is_night(at(3, 59), open));
    EXPECT_TRUE(usual.is_night(at(4), open)) << "it has ended";
  }
  const HoursOverride closed{false, at(1), at(10)};
  EXPECT_TRUE(settings(kZurich).is_night(at(2, 30), closed)) << "closed, though the settings say until three";
  EXPECT_FALSE(settings(kZurich).is_night(at(5), closed));
}

TEST(UpdateSettings, allow_no_update_while_the_clock_is_not_set) {
  EXPECT_FALSE(settings("[update]\nhours = \"00:00-24:00\"\n").is_night(WallTime{}));
}

TEST(UpdateSettings, name_a_mistake) {
  for (const char* const wrong :
       {"hours = \"2-5\"", "hours = \"\"", "hours = \"closed\"", "from_farms = true", "hours = 3"}) {
    const auto read = parse_update_settings(std::string("[update]\n") + wrong + "\n", "site.toml");
    if (std::string(wrong) == "hours = \"closed\"") {
      EXPECT_TRUE(read) << "never";
      continue;
    }
    ASSERT_FALSE(read) << wrong;
    EXPECT_THAT(read.error().message(), HasSubstr("site.toml:2"));
  }
}

}  // namespace
}  // namespace cyclorama::update

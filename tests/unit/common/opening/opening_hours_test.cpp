// SPDX-License-Identifier: Apache-2.0
#include "common/opening/opening_hours.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cyclorama {
namespace {

using std::chrono::minutes;
using ::testing::HasSubstr;

constexpr auto kZone = "Europe/Zurich";  // CET; CEST from 2026-03-29 02:00 to 2026-10-25 03:00.

OpeningHours hours(const std::vector<std::string>& lines, const std::string& zone = kZone) {
  auto parsed = OpeningHours::parse(lines, zone);
  EXPECT_TRUE(parsed) << parsed.error().message();
  return parsed ? *std::move(parsed) : OpeningHours();
}

/// Parses a UTC time.
WallTime utc(const std::string& text) {
  absl::Time time;
  std::string error;
  EXPECT_TRUE(absl::ParseTime("%Y-%m-%d %H:%M:%S", text, &time, &error)) << error;
  return absl::ToChronoTime(time);
}
/// Parses a local time that occurs exactly once.
WallTime local(const std::string& text) {
  absl::TimeZone zone;
  absl::LoadTimeZone(kZone, &zone);
  absl::Time time;
  std::string error;
  EXPECT_TRUE(absl::ParseTime("%Y-%m-%d %H:%M:%S", text, zone, &time, &error)) << error;
  return absl::ToChronoTime(time);
}

std::string complaint(const std::vector<std::string>& lines, const std::string& zone = kZone) {
  const auto parsed = OpeningHours::parse(lines, zone);
  return parsed ? "" : parsed.error().message();
}

TEST(OpeningHours, are_unlimited_by_default) { EXPECT_TRUE(OpeningHours().is_open(local("2026-12-25 03:00:00"))); }

TEST(OpeningHours, begin_with_their_first_second_and_end_with_their_last) {
  const OpeningHours week = hours({"Tue-Sun 10:00-18:00"});
  EXPECT_FALSE(week.is_open(local("2026-11-24 09:59:59")));  // Tuesday.
  EXPECT_TRUE(week.is_open(local("2026-11-24 10:00:00")));
  EXPECT_TRUE(week.is_open(local("2026-11-24 17:59:59")));
  EXPECT_FALSE(week.is_open(local("2026-11-24 18:00:00")));
  EXPECT_FALSE(week.is_open(local("2026-11-23 12:00:00")));  // Monday.
  EXPECT_TRUE(week.is_open(local("2026-11-29 12:00:00")));   // Sunday.
}

TEST(OpeningHours, add_up_over_several_lines) {
  const OpeningHours week = hours({"Mon,Thu-Fri 10:00-12:00,14:00-18:00", "Thu 17:00-22:00", "Sat-Mon 08:00-09:00"});
  for (const char* open : {"2026-11-23 10:30:00", "2026-11-23 08:30:00", "2026-11-26 15:00:00", "2026-11-26 21:59:59",
                           "2026-11-27 11:00:00", "2026-11-28 08:00:00", "2026-11-29 08:00:00"}) {
    EXPECT_TRUE(week.is_open(local(open))) << open;
  }
  for (const char* closed : {"2026-11-23 13:00:00", "2026-11-24 11:00:00", "2026-11-25 08:30:00", "2026-11-26 22:00:00",
                             "2026-11-27 18:30:00", "2026-11-28 10:30:00"}) {
    EXPECT_FALSE(week.is_open(local(closed))) << closed;
  }
}

TEST(OpeningHours, continue_after_midnight) {
  const OpeningHours week = hours({"Fri,Sat 22:00-02:00", "Sun 00:00-24:00"});
  EXPECT_FALSE(week.is_open(local("2026-11-27 21:59:59")));
  EXPECT_TRUE(week.is_open(local("2026-11-27 23:59:59")));
  EXPECT_TRUE(week.is_open(local("2026-11-28 00:00:00")));
  EXPECT_TRUE(week.is_open(local("2026-11-28 01:59:59")));
  EXPECT_FALSE(week.is_open(local("2026-11-28 02:00:00")));
  EXPECT_TRUE(week.is_open(local("2026-11-29 02:00:00")));
  EXPECT_TRUE(week.is_open(local("2026-11-29 23:59:59")));
  EXPECT_FALSE(week.is_open(local("2026-11-30 00:00:00")));  // Sunday's hours do not continue past midnight.
}

TEST(OpeningHours, of_a_date_replace_those_of_its_weekday) {
  const OpeningHours year = hours(
      {"Mon-Sun 10:00-18:00", "Thu 20:00-01:00", "2026-12-24 10:00-14:00", "2026-12-25 closed", "2026-12-31 closed"});
  EXPECT_TRUE(year.is_open(local("2026-12-24 13:59:59")));  // Thursday.
  EXPECT_FALSE(year.is_open(local("2026-12-24 14:00:00")));
  EXPECT_FALSE(year.is_open(local("2026-12-24 21:00:00")));
  EXPECT_FALSE(year.is_open(local("2026-12-25 00:30:00")));  // The hours after midnight belong to Thursday.
  EXPECT_FALSE(year.is_open(local("2026-12-25 12:00:00")));
  EXPECT_TRUE(year.is_open(local("2026-12-26 12:00:00")));
  EXPECT_FALSE(year.is_open(local("2026-12-31 12:00:00")));
  EXPECT_TRUE(year.is_open(local("2027-01-01 12:00:00")));
  EXPECT_TRUE(year.is_open(local("2027-12-25 12:00:00")));  // Another year.
}

TEST(OpeningHours, follow_local_time_in_summer_and_winter) {
  const OpeningHours week = hours({"Mon-Sun 10:00-18:00"});
  EXPECT_FALSE(week.is_open(utc("2026-07-01 07:59:59")));
  EXPECT_TRUE(week.is_open(utc("2026-07-01 08:00:00")));
  EXPECT_FALSE(week.is_open(utc("2026-01-05 08:59:59")));
  EXPECT_TRUE(week.is_open(utc("2026-01-05 09:00:00")));
  // On the days of the change.
  EXPECT_TRUE(week.is_open(utc("2026-03-29 08:00:00")));
  EXPECT_FALSE(week.is_open(utc("2026-03-29 16:00:00")));
  EXPECT_FALSE(week.is_open(utc("2026-10-25 08:59:59")));
  EXPECT_TRUE(week.is_open(utc("2026-10-25 16:59:59")));
}

TEST(OpeningHours, use_the_moment_of_the_change_for_an_hour_that_a_day_lacks) {
  // On 29 March, 02:00 is followed by 03:00, at 01:00 UTC.
  const OpeningHours from_within = hours({"Sun 02:30-04:00"});
  EXPECT_FALSE(from_within.is_open(utc("2026-03-29 00:59:59")));
  EXPECT_TRUE(from_within.is_open(utc("2026-03-29 01:00:00")));
  EXPECT_FALSE(from_within.is_open(utc("2026-03-29 02:00:00")));
  const OpeningHours until_within = hours({"Sat 22:00-02:30"});
  EXPECT_TRUE(until_within.is_open(utc("2026-03-29 00:59:59")));
  EXPECT_FALSE(until_within.is_open(utc("2026-03-29 01:00:00")));
  EXPECT_FALSE(hours({"Sun 02:10-02:50"}).is_open(utc("2026-03-29 01:00:00")));
}

TEST(OpeningHours, are_open_throughout_an_hour_that_occurs_twice) {
  // On 25 October, 02:00 to 03:00 occurs twice, from 00:00 and from 01:00 UTC.
  const auto changes = [](const OpeningHours& night) {
    std::vector<std::string> at;
    bool was = night.is_open(utc("2026-10-24 18:00:00"));
    for (WallTime t = utc("2026-10-24 18:00:00"); t < utc("2026-10-25 06:00:00"); t += minutes(1)) {
      if (night.is_open(t) == was) continue;
      was = !was;
      at.push_back(absl::FormatTime("%H:%M", absl::FromChrono(t), absl::UTCTimeZone()));
    }
    return at;
  };
  EXPECT_THAT(changes(hours({"Sat 22:00-02:30"})), ::testing::ElementsAre("20:00", "01:30"));
  EXPECT_THAT(changes(hours({"Sun 02:30-05:00"})), ::testing::ElementsAre("00:30", "04:00"));
  EXPECT_THAT(changes(hours({"Sun 02:10-02:50"})), ::testing::ElementsAre("00:10", "01:50"));
}

TEST(OpeningHours, are_independent_of_the_moment_at_which_they_are_evaluated) {
  // A computer that starts in the middle has only the current time.
  const std::vector<std::string> lines{"Mon-Fri 09:00-17:00", "Sat 20:00-03:00"};
  const OpeningHours kept = hours(lines);
  for (WallTime t = utc("2026-10-20 00:00:00"); t < utc("2026-10-30 00:00:00"); t += minutes(17))
    ASSERT_EQ(kept.is_open(t), hours(lines).is_open(t));
}

TEST(OpeningHours, are_open_while_the_clock_is_not_set) {
  const OpeningHours never = hours({"2026-12-24 10:00-14:00"});
  for (const char* unset : {"1970-01-01 00:00:07", "2000-01-01 03:00:00", "2025-12-31 23:59:59"})
    EXPECT_TRUE(never.is_open(utc(unset))) << unset;
  EXPECT_FALSE(never.is_open(utc("2026-01-01 00:00:00")));
  EXPECT_FALSE(never.is_open(utc("2199-01-01 00:00:00")));
}

TEST(OpeningHours, support_other_time_zones) {
  const OpeningHours far = hours({"Mon-Sun 10:00-18:00"}, "Pacific/Kiritimati");  // 14 hours ahead of UTC.
  EXPECT_TRUE(far.is_open(utc("2026-06-30 20:00:00")));
  EXPECT_FALSE(far.is_open(utc("2026-06-30 04:00:00")));
}

TEST(OpeningHours, refuse_invalid_text) {
  for (const char* line : {"",
                           " ",
                           "Mon",
                           "Mon ",
                           "10:00-18:00",
                           "Mon 10:00",
                           "Mon 10:00-",
                           "Mon 10-18",
                           "Mon 10:00-18:00 ",
                           "Mon  10:00-18:00",
                           "Mon 10:00-10:00",
                           "Mon 24:00-02:00",
                           "Mon 10:00-24:01",
                           "Mon 10:60-18:00",
                           "Mon 1:00-2:00",
                           "Mon -1:00-02:00",
                           "Mon 10:00-18:00,",
                           "Mon, 10:00-18:00",
                           "Mon- 10:00-18:00",
                           "Mon-Tue-Wed 10:00-18:00",
                           "mon 10:00-18:00",
                           "Montag 10:00-18:00",
                           "2026-02-30 closed",
                           "2026-13-01 closed",
                           "26-12-25 closed",
                           "2026-12-25 shut",
                           "2026-12-24-2026-12-26 closed",
                           "Mon 10:00-12:00-14:00"}) {
    EXPECT_THAT(complaint({line}), HasSubstr("write days and hours")) << line;
  }
  EXPECT_THAT(complaint({}), HasSubstr("never open"));
  EXPECT_THAT(complaint({"Mon closed"}, "Europe/Nowhere"), HasSubstr("no time zone"));
  EXPECT_EQ(complaint({"Mon 00:00-24:00", "2028-02-29 closed"}, ""), "");
}

TEST(OpeningHours, are_read_from_site_toml) {
  const auto read = [](const std::string& text) -> std::string {
    auto config = Config::parse(text, "site.toml");
    EXPECT_TRUE(config);
    ConfigTable root = config->root();
    const OpeningHours found = read_opening_hours(&root);
    if (const auto finished = config->finish(); !finished) return finished.error().message();
    return found.is_open(local("2026-11-24 03:00:00")) ? "open" : "closed";
  };
  EXPECT_EQ(read(""), "open");
  EXPECT_EQ(read("[hours]\nopen = [\"Tue 10:00-12:00\"]\n"), "closed");
  EXPECT_EQ(read("[hours]\nopen = [\"Tue 10:00-12:00\"]\ntime_zone = \"Asia/Tokyo\"\n"), "open");
  EXPECT_THAT(read("[hours]\nopen = [\"Tue\"]\n"), HasSubstr("site.toml:2: hours.open: 'Tue': write days and hours"));
  EXPECT_THAT(read("[hours]\ntime_zone = \"Asia/Tokyo\"\n"), HasSubstr("open"));
  EXPECT_THAT(read("[hours]\nopen = [\"Tue closed\"]\nclosed = true\n"), HasSubstr("site.toml:3"));
}

}  // namespace
}  // namespace cyclorama

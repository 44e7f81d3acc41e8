// SPDX-License-Identifier: Apache-2.0
#include "common/opening/hours_override.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>

namespace cyclorama {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

constexpr auto kZone = "Europe/Zurich";

OpeningHours hours(const std::vector<std::string>& lines) {
  auto parsed = OpeningHours::parse(lines, kZone);
  EXPECT_TRUE(parsed);
  return *std::move(parsed);
}
/// Parses a civil time in Zurich.
WallTime local(const std::string& text) {
  absl::TimeZone zone;
  absl::LoadTimeZone(kZone, &zone);
  absl::Time time;
  std::string error;
  EXPECT_TRUE(absl::ParseTime("%Y-%m-%d %H:%M:%S", text, zone, &time, &error)) << error;
  return absl::ToChronoTime(time);
}
HoursOverride opened(const OpeningHours& hours, const char* until, WallTime now) {
  const auto made = open_until(hours, until, now);
  EXPECT_TRUE(made) << made.error().message();
  return made ? *made : HoursOverride{};
}
HoursOverride closed(const OpeningHours& hours, WallTime now) {
  const auto made = closed_for_today(hours, now);
  EXPECT_TRUE(made);
  return made ? *made : HoursOverride{};
}

TEST(HoursOverride, keeps_a_museum_open_until_the_given_time) {
  const OpeningHours week = hours({"Tue-Sun 10:00-18:00"});
  const WallTime evening = local("2026-11-24 17:30:12");  // Tuesday.
  const HoursOverride override = opened(week, "22:00", evening);
  EXPECT_EQ(override.until, local("2026-11-24 22:00:00"));
  EXPECT_FALSE(week.is_open(local("2026-11-24 21:59:59")));
  EXPECT_TRUE(is_open(week, override, local("2026-11-24 21:59:59")));
  EXPECT_FALSE(is_open(week, override, local("2026-11-24 22:00:00")));
  EXPECT_TRUE(is_open(week, override, local("2026-11-25 12:00:00"))) << "as the settings say";
  EXPECT_EQ(opened(week, "24:00", evening).until, local("2026-11-25 00:00:00"));
  EXPECT_EQ(opened(week, "02:00", evening).until, local("2026-11-25 02:00:00")) << "a long night";
}

TEST(HoursOverride, keeps_a_museum_closed_until_it_opens_on_a_later_day) {
  const OpeningHours week = hours({"Tue-Sun 10:00-18:00", "Fri 22:00-02:00"});
  EXPECT_EQ(closed(week, local("2026-11-24 12:00:00")).until, local("2026-11-25 10:00:00"));
  EXPECT_EQ(closed(week, local("2026-11-29 12:00:00")).until, local("2026-12-01 10:00:00")) << "Monday is closed, too";
  EXPECT_EQ(closed(week, local("2026-11-27 20:00:00")).until, local("2026-11-28 10:00:00")) << "past two in the night";
  EXPECT_EQ(closed(week, local("2026-11-24 09:00:00")).until, local("2026-11-25 10:00:00")) << "before today's opening";
  const HoursOverride override = closed(week, local("2026-11-24 12:00:00"));
  EXPECT_FALSE(is_open(week, override, local("2026-11-24 12:00:00")));
  EXPECT_TRUE(is_open(week, override, local("2026-11-25 10:00:00")));
  EXPECT_EQ(closed(hours({"2020-01-01 10:00-12:00"}), local("2026-11-24 12:00:00")).until,
            local("2026-11-25 00:00:00"));
  const OpeningHours always;
  const WallTime until = closed(always, local("2026-11-24 12:00:00")).until;
  EXPECT_EQ(absl::ToCivilSecond(absl::FromChrono(until), always.zone()), absl::CivilSecond(2026, 11, 25, 0, 0, 0));
}

TEST(HoursOverride, is_refused_without_a_clock_or_a_time) {
  const OpeningHours always = hours({"Mon-Sun 00:00-24:00"});
  EXPECT_EQ(open_until(always, "22:00", WallTime{}).error().code(), ErrorCode::kUnavailable);
  EXPECT_EQ(closed_for_today(always, WallTime{}).error().code(), ErrorCode::kUnavailable);
  const WallTime noon = local("2026-11-24 12:00:00");
  for (const char* const wrong : {"", "22", "22:0", "22:60", "24:01", "99:99", "-1:00", "22:00 ", "2a:00", "22.00"}) {
    const auto made = open_until(always, wrong, noon);
    ASSERT_FALSE(made) << wrong;
    EXPECT_THAT(made.error().message(), HasSubstr("such as 22:00")) << wrong;
  }
  for (const char* const over : {"12:00", "11:59", "06:01"}) {
    const auto made = open_until(always, over, noon);
    ASSERT_FALSE(made) << over;
    EXPECT_THAT(made.error().message(), HasSubstr("is over for today")) << over;
  }
}

TEST(HoursOverride, is_ignored_if_the_clock_is_before_its_start) {
  const OpeningHours week = hours({"Tue-Sun 10:00-18:00"});
  const HoursOverride override = closed(week, local("2026-11-24 12:00:00"));
  EXPECT_TRUE(is_open(week, override, local("2026-11-24 11:59:59"))) << "the battery on the board was empty";
}

/// Every kind of override, at any time, around both changes of the clocks.
TEST(HoursOverride, never_lasts_beyond_its_end) {
  std::mt19937 random(8);
  const OpeningHours settings[] = {hours({"Tue-Sun 10:00-18:00"}), hours({"Mon-Sun 00:00-24:00"}),
                                   hours({"Fri,Sat 22:00-03:00", "Sun 09:00-10:00"}), hours({"Mon 02:30-02:45"})};
  int made = 0;
  for (int i = 0; i < 300; ++i) {
    const OpeningHours& week = settings[random() % 4];
    const char* const begin = random() % 2 == 0 ? "2026-03-27 00:00:00" : "2026-10-23 00:00:00";
    const WallTime now = local(begin) + std::chrono::milliseconds(random() % (4u * 86'400'000u));
    const auto said =
        random() % 2 == 0
            ? closed_for_today(week, now)
            : open_until(week,
                         absl::FormatTime("%H:%M", absl::FromUnixSeconds(static_cast<std::int64_t>(random() % 86400)),
                                          absl::UTCTimeZone()),
                         now);
    if (!said) continue;
    ++made;
    ASSERT_TRUE(said->holds(now));
    ASSERT_GT(said->until, now);
    ASSERT_LE(said->until - said->set_at, kMaxOverrideDuration);
    const auto kept = parse_hours_override(to_text(*said));
    ASSERT_TRUE(kept) << to_text(*said);
    ASSERT_EQ(*kept, *said);
    for (const auto after : {0s, 1s, 3600s, 86400s, 31'536'000s}) {
      ASSERT_EQ(is_open(week, *said, said->until + after), week.is_open(said->until + after)) << to_text(*said);
    }
    for (const auto before : {1s, 3600s, 31'536'000s}) {
      ASSERT_EQ(is_open(week, *said, said->set_at - before), week.is_open(said->set_at - before));
    }
    const WallTime within = said->set_at + (said->until - said->set_at) / (1 + static_cast<int>(random() % 9)) - 1ms;
    ASSERT_EQ(is_open(week, *said, std::max(now, within)), said->is_open);
  }
  EXPECT_GT(made, 100);
}

TEST(HoursOverride, is_refused_when_its_file_is_damaged) {
  const std::string good = "open from 2026-11-24T17:02:11Z until 2026-11-24T21:00:00Z\n";
  ASSERT_TRUE(parse_hours_override(good));
  for (std::size_t size = 0; size < good.size(); ++size) EXPECT_FALSE(parse_hours_override(good.substr(0, size)));
  for (const char* const bad :
       {"open from 2026-11-24T17:02:11Z until 2026-11-24T17:02:11Z\n",      // Empty duration.
        "open from 2026-11-24T17:02:11Z until 2026-11-23T21:00:00Z\n",      // Ends before it begins.
        "open from 2026-11-24T17:02:11Z until 2027-11-24T21:00:00Z\n",      // Too long.
        "open from 2026-11-24T17:02:11Z until infinite-future\n",           //
        "open from infinite-past until 2026-11-24T21:00:00Z\n",             //
        "open from 2026-11-24T17:02:11Z until 2026-13-24T21:00:00Z\n",      //
        "open from 2026-11-24T17:02:11Z until 2026-11-24T21:00:00Z\nmore",  //
        "ajar from 2026-11-24T17:02:11Z until 2026-11-24T21:00:00Z\n",      //
        "open from  2026-11-24T17:02:11Z until 2026-11-24T21:00:00Z\n",     //
        "open until 2026-11-24T21:00:00Z from 2026-11-24T17:02:11Z\n"}) {
    EXPECT_FALSE(parse_hours_override(bad)) << bad;
  }
}

TEST(OverriddenHours, follow_the_file_as_it_appears_disappears_and_breaks) {
  std::string name = (std::filesystem::temp_directory_path() / "hours-XXXXXX").string();
  ASSERT_NE(::mkdtemp(name.data()), nullptr);
  const std::filesystem::path file = std::filesystem::path(name) / "override";
  const auto write = [&](const std::string& text) { std::ofstream(file) << text; };
  const OpeningHours week = hours({"Tue-Sun 10:00-18:00"});
  OverriddenHours both(week, file);
  WallTime now = local("2026-11-24 19:00:00");
  EXPECT_FALSE(both.is_open(now));
  write(to_text(opened(week, "22:00", now)));
  EXPECT_TRUE(both.is_open(now += 1s));
  OverriddenHours started_again(week, file);
  EXPECT_TRUE(started_again.is_open(now)) << "it survives a restart";
  EXPECT_FALSE(both.is_open(local("2026-11-24 22:00:00"))) << "though nobody took the file away";
  EXPECT_TRUE(both.is_open(now += 1s)) << "the clock was put back";
  write("open for ever\n");
  EXPECT_FALSE(both.is_open(now += 1s));
  write(to_text(closed(week, now)));
  EXPECT_FALSE(both.is_open(local("2026-11-25 09:59:59")));
  EXPECT_TRUE(both.is_open(local("2026-11-25 10:00:00")));
  std::filesystem::remove_all(name);
  EXPECT_TRUE(both.is_open(local("2026-11-26 10:00:00")));
  EXPECT_FALSE(read_hours_override("/").has_value()) << "a folder";
}

}  // namespace
}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
#include "kiosk/care/visit_counts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cyclorama::care {
namespace {

using namespace std::chrono_literals;
using ::testing::IsEmpty;

WallSeconds at(std::chrono::seconds time) { return WallSeconds(1'800'000'000s + time); }

/// Somebody steers from `begin` to `end`; then nobody does for two minutes.
void visit(VisitCounts* counts, std::chrono::seconds begin, std::chrono::seconds end, const std::string& day) {
  for (auto time = begin; time <= end; time += 1s) counts->update(true, at(time), day);
  for (auto time = end + 1s; time <= end + 120s; time += 1s) counts->update(false, at(time), day);
}

TEST(VisitCounts, counts_visits_and_their_time_for_each_day) {
  VisitCounts counts;
  visit(&counts, 0s, 300s, "2026-11-24");
  visit(&counts, 1000s, 1100s, "2026-11-24");
  visit(&counts, 90000s, 90060s, "2026-11-25");
  EXPECT_EQ(counts.days().at("2026-11-24"), (VisitCounts::Day{2, 400.0}));
  EXPECT_EQ(counts.days().at("2026-11-25"), (VisitCounts::Day{1, 60.0}));
  EXPECT_EQ(counts.total(), (VisitCounts::Day{3, 460.0}));
  EXPECT_FALSE(counts.is_visited());
}

TEST(VisitCounts, takes_a_pause_of_less_than_a_minute_as_the_same_visit_and_a_touch_as_none) {
  VisitCounts counts;
  counts.update(true, at(0s), "2026-11-24");
  counts.update(false, at(59s), "2026-11-24");
  EXPECT_TRUE(counts.is_visited());
  counts.update(true, at(70s), "2026-11-24");
  counts.update(false, at(200s), "2026-11-24");
  EXPECT_EQ(counts.total(), (VisitCounts::Day{1, 70.0}));
  visit(&counts, 1000s, 1003s, "2026-11-24");
  EXPECT_EQ(counts.total().visits, 1);
}

TEST(VisitCounts, ignores_a_visit_in_which_the_clock_was_set_back) {
  VisitCounts counts;
  counts.update(true, at(1000s), "2026-11-24");
  counts.update(false, at(0s), "2026-11-24");
  counts.update(false, at(100s), "2026-11-24");
  EXPECT_EQ(counts.total().visits, 0);
}

TEST(VisitCounts, keeps_a_year_and_survives_a_restart) {
  VisitCounts counts;
  for (int day = 0; day < 500; ++day) {
    visit(&counts, day * 86400s, day * 86400s + 10s, std::to_string(20260000 + day));
  }
  EXPECT_EQ(counts.days().size(), VisitCounts::kMaxDays);
  EXPECT_EQ(counts.total().visits, 500);
  VisitCounts after;
  ASSERT_TRUE(after.read_json(counts.to_json(), "visits.json"));
  EXPECT_EQ(after.days(), counts.days());
  EXPECT_EQ(after.total(), counts.total());
  for (const char* const bad : {"", "{}", R"({"version": 1, "total": {}, "days": []})",
                                R"({"version": 1, "total": {"visits": -1, "seconds": 0}, "days": []})"}) {
    EXPECT_FALSE(after.read_json(bad, "visits.json")) << bad;
    EXPECT_EQ(after.total().visits, 500);
  }
}

TEST(VisitCounts, writes_nothing_but_counts) {
  VisitCounts counts;
  visit(&counts, 0s, 300s, "2026-11-24");
  EXPECT_EQ(counts.to_json(),
            "{\n \"version\": 1,\n \"total\": {\n  \"visits\": 1,\n  \"seconds\": 300.0\n },\n \"days\": [\n  {\n   "
            "\"visits\": 1,\n   \"seconds\": 300.0,\n   \"date\": \"2026-11-24\"\n  }\n ]\n}\n");
}

}  // namespace
}  // namespace cyclorama::care

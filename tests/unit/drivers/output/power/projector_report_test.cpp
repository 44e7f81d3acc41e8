// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/power/projector_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cyclorama::output {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using Level = ProjectorReport::Level;
using enum ProjectorPower;

struct Watched {
  ProjectorReporter reporter;
  TimePoint now{};
  ProjectorReport after(Duration time, bool should_be_on, Result<ProjectorPower> power) {
    now += time;
    return reporter.see({should_be_on, std::move(power), std::nullopt}, now);
  }
};

TEST(ProjectorReport, reports_nothing_about_a_lamp_that_works) {
  Watched watched;
  EXPECT_EQ(watched.after(0s, false, kOff).level, Level::kOk);
  EXPECT_EQ(watched.after(20s, true, kOff).level, Level::kOk) << "the museum opened this moment";
  EXPECT_EQ(watched.after(20s, true, kWarming).level, Level::kOk);
  EXPECT_EQ(watched.after(100s, true, kWarming).level, Level::kOk);
  EXPECT_EQ(watched.after(20s, true, kOn).level, Level::kOk);
  EXPECT_EQ(watched.after(8h, true, kOn).level, Level::kOk);
  EXPECT_EQ(watched.after(20s, false, kOn).level, Level::kOk);
  EXPECT_EQ(watched.after(20s, false, kCooling).level, Level::kOk);
}

TEST(ProjectorReport, reports_a_lamp_that_is_off_while_the_museum_is_open) {
  Watched watched;
  watched.after(0s, true, kOn);
  EXPECT_EQ(watched.after(20s, true, kOff).level, Level::kOk);
  const ProjectorReport report = watched.after(100s, true, kOff);
  EXPECT_EQ(report.level, Level::kFault);
  EXPECT_THAT(report.sentence, HasSubstr("lamp is off"));
  EXPECT_THAT(report.remedy, HasSubstr("remote control"));
  EXPECT_EQ(watched.after(20s, true, kOn).level, Level::kOk);
  EXPECT_EQ(watched.after(20s, false, kOn).level, Level::kOk);
  EXPECT_EQ(watched.after(100s, false, kOn).level, Level::kWarning);
}

TEST(ProjectorReport, reports_a_lamp_that_never_reaches_its_state) {
  Watched watched;
  watched.after(0s, true, kWarming);
  EXPECT_EQ(watched.after(10min, true, kWarming).level, Level::kWarning);
  watched.after(0s, false, kCooling);
  EXPECT_EQ(watched.after(10min, false, kCooling).level, Level::kWarning);
}

TEST(ProjectorReport, reports_why_a_lamp_is_not_switched) {
  for (const auto& [code, words] : {std::pair(ErrorCode::kUnavailable, "does not answer"),
                                    {ErrorCode::kInvalidArgument, "password"},
                                    {ErrorCode::kBadData, "no projector"},
                                    {ErrorCode::kSystem, "failure"}}) {
    const ProjectorReport report = Watched().after(0s, true, Error(code, "projector at [::1]:4352: so it is"));
    EXPECT_NE(report.level, Level::kOk);
    EXPECT_THAT(report.sentence, HasSubstr(words));
    EXPECT_FALSE(report.remedy.empty());
  }
}

TEST(ProjectorReport, passes_on_the_projectors_own_warnings) {
  const auto errors = pjlink::parse_errors("%1ERST=020010");
  ASSERT_TRUE(errors);
  const ProjectorReport report = ProjectorReporter().see({true, kOn, *errors}, TimePoint{});
  EXPECT_EQ(report.level, Level::kFault);
  EXPECT_THAT(report.sentence, HasSubstr("lamp (error), filter (warning)"));
  EXPECT_THAT(report.remedy, HasSubstr("have it replaced"));
  const auto none = pjlink::parse_errors("%1ERST=000000");
  ASSERT_TRUE(none);
  EXPECT_EQ(ProjectorReporter().see({true, kOn, *none}, TimePoint{}).level, Level::kOk);
  const auto warning = pjlink::parse_errors("%1ERST=001000");
  ASSERT_TRUE(warning);
  EXPECT_EQ(ProjectorReporter().see({false, kOff, *warning}, TimePoint{}).level, Level::kWarning);
  for (const char* const wrong : {"", "%1ERST=", "%1ERST=00000", "%1ERST=0000000", "%1ERST=000003", "%1POWR=000000",
                                  "%1ERST=ERR1", "PJLINK ERRA"}) {
    EXPECT_FALSE(pjlink::parse_errors(wrong)) << wrong;
  }
}

}  // namespace
}  // namespace cyclorama::output

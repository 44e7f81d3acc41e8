// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/health.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/doubles/fake_process.h"

namespace cyclorama::operations {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A display with two lit heads, and a tour whose farm is away.
struct Museum {
  FakeProcess tour{"tour"};
  FakeProcess display{"display"};
  std::vector<ProcessLink> links;
  HealthRules rules;

  Museum() {
    auto made = make_links({{"tour", tour.address()}, {"display", display.address()}});
    CHECK(made);
    links = *std::move(made);
    tour.inspection.set_state("The farm is away.", false);
    display.inspection.set_fact("heads", "2");
    display.inspection.set_gauge("awake", 1.0);
    for (const char* const head : {"left", "right"}) {
      display.inspection.set_gauge(std::string("lit: ") + head, 1.0);
      display.inspection.set_picture(std::string("projector/") + head, ramp_picture(0));
    }
  }
  [[nodiscard]] std::vector<std::string> missing() const { return still_missing(look_at(links), rules); }
};

TEST(Health, is_good_with_a_picture_on_every_head_although_the_farm_is_away) {
  Museum museum;
  museum.rules.heads = 2;
  EXPECT_THAT(museum.missing(), IsEmpty());
}

TEST(Health, reports_a_head_that_is_dark_blank_or_without_a_picture) {
  Museum museum;
  museum.display.inspection.set_gauge("lit: left", 0.0);
  museum.display.inspection.set_picture("projector/right", std::make_shared<RgbImage>(64, 32));
  EXPECT_THAT(museum.missing(), ElementsAre(HasSubstr("head 'left' is dark"), HasSubstr("it is blank")));
  museum.display.inspection.set_gauge("lit: third", 1.0);
  EXPECT_THAT(museum.missing(), Contains(HasSubstr("head 'third' has given no picture")));
}

TEST(Health, reports_missing_heads) {
  Museum museum;
  museum.rules.heads = 3;
  EXPECT_THAT(museum.missing(), ElementsAre(HasSubstr("2 heads of 3")));
}

TEST(Health, allows_a_display_to_sleep_while_the_museum_is_closed_unless_it_is_broken) {
  Museum museum;
  museum.display.inspection.set_gauge("awake", 0.0);
  for (const char* const lit : {"lit: left", "lit: right"}) museum.display.inspection.set_gauge(lit, 0.0);
  EXPECT_THAT(museum.missing(), IsEmpty());
  museum.display.inspection.set_picture("projector/left", std::make_shared<RgbImage>(64, 32));
  EXPECT_THAT(museum.missing(), ElementsAre(HasSubstr("'left' has a picture, but it is blank")));
  museum.display.inspection.set_state("Shows nothing: no card.", false);
  EXPECT_THAT(museum.missing(), Contains(HasSubstr("no card")));
}

TEST(Health, allows_heads_that_were_dark_before_the_restart_if_they_have_a_picture) {
  Museum museum;
  museum.display.inspection.set_gauge("lit: left", 0.0);
  EXPECT_THAT(dark_heads(look_at(museum.links)), ElementsAre("left"));
  museum.rules.may_be_dark = {"left"};
  EXPECT_THAT(museum.missing(), IsEmpty());
  museum.display.inspection.set_gauge("lit: right", 0.0);
  EXPECT_THAT(museum.missing(), ElementsAre(HasSubstr("head 'right' is dark")));
  museum.display.inspection.set_gauge("lit: right", 1.0);
  museum.display.inspection.set_picture("projector/left", std::make_shared<RgbImage>(64, 32));
  EXPECT_THAT(museum.missing(), ElementsAre(HasSubstr("'left' has a picture, but it is blank")));
}

TEST(Health, reports_required_processes_that_are_unhealthy_absent_or_unknown) {
  Museum museum;
  museum.rules.well = {"tour", "tracker"};
  EXPECT_THAT(museum.missing(),
              ElementsAre(HasSubstr("tour is not well: The farm is away"), HasSubstr("--watch tracker=")));
  auto gone = make_links({{"tracker", "[::1]:1"}});
  ASSERT_TRUE(gone);
  EXPECT_THAT(still_missing(look_at(*gone), {{}, 0, 1, {}}), ElementsAre(HasSubstr("tracker is away")));
}

TEST(Health, starts_counting_anew_when_a_process_died_between_two_checks) {
  Museum museum;
  HealthRules rules;
  rules.looks = 2;
  HealthCount count(rules);
  HealthSnapshot look = look_at(museum.links);
  count.take(look);
  EXPECT_FALSE(count.is_well());
  look.processes[0].status->set_uptime_s(0.0);
  count.take(look);
  EXPECT_FALSE(count.is_well());
  EXPECT_THAT(count.missing(), ElementsAre("tour was started again meanwhile"));
  count.take(look);
  EXPECT_FALSE(count.is_well());
  count.take(look);
  EXPECT_TRUE(count.is_well());
  const auto json = nlohmann::json::parse(health_json(count, 12.5));
  EXPECT_EQ(json["well"], true);
  EXPECT_EQ(json["seconds"], 12.5);
}

TEST(Health, is_not_good_before_the_first_check) {
  const HealthCount count{HealthRules{}};
  EXPECT_FALSE(count.is_well());
  EXPECT_THAT(count.missing(), ElementsAre(HasSubstr("nothing has been looked at")));
}

}  // namespace
}  // namespace cyclorama::operations

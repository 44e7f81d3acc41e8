// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/healing_controller.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "tests/doubles/fake_calibrator.h"

namespace cyclorama::operations {
namespace {

using ::testing::HasSubstr;

TEST(HealingController, describes_how_projectors_are_kept_in_place) {
  FakeCalibrator calibrator;
  const auto controller = HealingController::make(calibrator.address());
  ASSERT_TRUE(controller);
  EXPECT_EQ((*controller)->json(), "null") << "nothing watches yet";
  tell_healing(&calibrator.inspection);
  const auto json = nlohmann::json::parse((*controller)->json());
  ASSERT_EQ(json["projectors"].size(), 3u);
  EXPECT_EQ(json["projectors"][1]["name"], "middle");
  EXPECT_EQ(json["projectors"][1]["last_px"], 23.4);
  EXPECT_TRUE(json["projectors"][0]["last_px"].is_null());
  EXPECT_EQ(json["projectors"][2]["state"], "in the way");
  EXPECT_EQ(json["names"].size(), 3u);
  EXPECT_EQ(json["history"].size(), 121u);
  EXPECT_EQ(json["history"][0].size(), 4u);
}

TEST(HealingController, does_not_trust_a_peers_numbers_and_texts) {
  wire::ProcessStatus status;
  EXPECT_EQ(watched_json(status), "null");
  wire::Table* const table = status.add_tables();
  table->set_name("watched projectors");
  table->add_columns("off_px");
  table->add_rows()->add_cells()->set_number(std::numeric_limits<double>::quiet_NaN());
  table->add_rows();
  wire::Table* const past = status.add_tables();
  past->set_name("watched history");
  for (int i = 0; i < 1000; ++i) past->add_columns("x");
  for (int i = 0; i < 1000; ++i) past->add_rows();
  const auto json = nlohmann::json::parse(watched_json(status));
  EXPECT_TRUE(json["projectors"][0]["off_px"].is_null() && json["projectors"][1]["name"].is_null());
  EXPECT_LT(json["history"].size(), 1000u);
  EXPECT_LT(json["names"].size(), 100u);
}

TEST(HealingController, passes_on_why_nothing_is_realigned) {
  FakeCalibrator calibrator;
  const auto controller = HealingController::make(calibrator.address());
  ASSERT_TRUE(controller && (*controller)->realign());
  EXPECT_EQ(calibrator.healing.realigned, 1);
  calibrator.healing.is_watching = false;
  const Status refused = (*controller)->realign();
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message(), HasSubstr("nothing watches the wall"));
}

TEST(HealingController, reports_which_correction_was_undone_or_that_there_is_none) {
  FakeCalibrator calibrator;
  const auto controller = HealingController::make(calibrator.address());
  ASSERT_TRUE(controller);
  const auto undone = (*controller)->undo();
  ASSERT_TRUE(undone) << undone.error().message();
  EXPECT_THAT(*undone, HasSubstr("projector 'middle'"));
  EXPECT_EQ((*controller)->undo().error().code(), ErrorCode::kNotFound);
  EXPECT_EQ(calibrator.healing.realigned, 0);
}

}  // namespace
}  // namespace cyclorama::operations

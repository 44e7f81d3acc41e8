// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/calibration_controller.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/doubles/fake_calibrator.h"

namespace cyclorama::operations {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

struct Controller {
  FakeCalibrator calibrator;
  std::unique_ptr<CalibrationController> controller;

  Controller() {
    auto made = CalibrationController::make(calibrator.address());
    CHECK(made);
    controller = *std::move(made);
  }
  [[nodiscard]] nlohmann::json now() const { return nlohmann::json::parse(controller->json()); }
  /// Returns the first answer with a state other than "running".
  [[nodiscard]] nlohmann::json end() const {
    const TimePoint deadline = SteadyClock().now() + 20s;
    while (now()["state"] == "running" && SteadyClock().now() < deadline) std::this_thread::yield();
    return now();
  }
};

TEST(CalibrationController, reports_the_outcome_of_a_calibration) {
  Controller controller;
  EXPECT_EQ(controller.now()["state"], "idle");
  ASSERT_TRUE(controller.controller->start({}));
  const auto end = controller.end();
  EXPECT_EQ(end["state"], "done");
  EXPECT_EQ(end["fraction"], 1.0);
  EXPECT_EQ(end["date"], "2026-11-22");
  EXPECT_EQ(end["remarks"].size(), 1u);
  EXPECT_EQ(controller.controller->picture(), "a picture");
  EXPECT_TRUE(controller.controller->start({})) << "and again";
}

TEST(CalibrationController, cancels_and_runs_one_calibration_at_a_time) {
  Controller controller;
  controller.calibrator.is_held = true;
  ASSERT_TRUE(controller.controller->start({}));
  const Status second = controller.controller->start({});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code(), ErrorCode::kBusy);
  EXPECT_FALSE(controller.controller->restore()) << "not while one runs";
  controller.controller->cancel();
  EXPECT_EQ(controller.end()["state"], "cancelled");
  controller.controller->cancel();
  controller.calibrator.is_held = false;
  ASSERT_TRUE(controller.controller->start({}));
  EXPECT_EQ(controller.end()["state"], "done");
}

TEST(CalibrationController, reports_why_one_failed) {
  Controller controller;
  controller.calibrator.messages.resize(1);
  controller.calibrator.end = to_grpc(Error(ErrorCode::kUnavailable, "projector 'left' is dark; switch it on"));
  ASSERT_TRUE(controller.controller->start({}));
  const auto end = controller.end();
  EXPECT_EQ(end["state"], "failed");
  EXPECT_THAT(end["error"].get<std::string>(), HasSubstr("projector 'left' is dark; switch it on"));
}

TEST(CalibrationController, reports_a_missing_calibrator) {
  auto controller = CalibrationController::make("[::1]:1");
  ASSERT_TRUE(controller);
  ASSERT_TRUE((*controller)->start({}));
  const TimePoint deadline = SteadyClock().now() + 20s;
  while (nlohmann::json::parse((*controller)->json())["state"] == "running" && SteadyClock().now() < deadline)
    std::this_thread::yield();
  EXPECT_EQ(nlohmann::json::parse((*controller)->json())["state"], "failed");
  EXPECT_FALSE((*controller)->restore());
}

TEST(CalibrationController, places_the_fixed_cameras) {
  Controller controller;
  EXPECT_EQ(controller.now()["what"], "wall");
  ASSERT_TRUE(controller.controller->place_cameras());
  const auto end = controller.end();
  EXPECT_EQ(end["what"], "cameras");
  EXPECT_EQ(end["state"], "done") << end;
  ASSERT_EQ(end["remarks"].size(), 2u);
  EXPECT_THAT(end["remarks"][0].get<std::string>(), HasSubstr("Camera 'left' saw 2814 places of the wall"));
  EXPECT_THAT(end["remarks"][1].get<std::string>(), HasSubstr("turn it to the wall"));
  controller.calibrator.healing.is_placing = true;
  ASSERT_TRUE(controller.controller->place_cameras());
  const Status second = controller.controller->start({});
  ASSERT_FALSE(second) << "the wall is measured by one at a time";
  EXPECT_EQ(second.error().code(), ErrorCode::kBusy);
  controller.controller->cancel();
  EXPECT_EQ(controller.end()["state"], "cancelled");
  controller.calibrator.healing.is_placing = false;
  controller.calibrator.healing.is_watching = false;
  ASSERT_TRUE(controller.controller->place_cameras());
  EXPECT_THAT(controller.end()["error"].get<std::string>(), HasSubstr("name one in calibrator.toml"));
  ASSERT_TRUE(controller.controller->start({}));
  EXPECT_EQ(controller.end()["what"], "wall");
}

TEST(CalibrationController, restores_the_previous_calibration) {
  Controller controller;
  const auto date = controller.controller->restore();
  ASSERT_TRUE(date);
  EXPECT_EQ(*date, "2026-10-01");
  controller.calibrator.restored_date.clear();
  const auto none = controller.controller->restore();
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code(), ErrorCode::kNotFound);
}

TEST(CalibrationController, stops_at_once_during_a_calibration) {
  Controller controller;
  controller.calibrator.is_held = true;
  ASSERT_TRUE(controller.controller->start({}));
  const TimePoint deadline = SteadyClock().now() + 20s;
  while (controller.controller->picture().empty() && SteadyClock().now() < deadline) std::this_thread::yield();
  controller.controller.reset();
  EXPECT_TRUE(controller.calibrator.wait_for_cancel());
}

TEST(CalibrationRequest, is_read_strictly) {
  const auto start =
      parse_calibration_request(R"({"do": "start", "quick": true, "projector": "left", "resume": false})");
  ASSERT_TRUE(start);
  EXPECT_TRUE(start->order.quick());
  EXPECT_EQ(start->order.projector(), "left");
  EXPECT_EQ(parse_calibration_request(R"({"do": "cancel"})")->kind, CalibrationRequest::Kind::kCancel);
  EXPECT_EQ(parse_calibration_request(R"({"do": "place-cameras"})")->kind, CalibrationRequest::Kind::kPlaceCameras);
  EXPECT_FALSE(parse_calibration_request(R"({"do": "place-cameras", "quick": true})"));
  const auto answer = parse_calibration_request(R"({"do": "answer", "text": "12.5"})");
  EXPECT_EQ(answer->kind, CalibrationRequest::Kind::kAnswer);
  EXPECT_EQ(answer->text, "12.5");
  EXPECT_FALSE(parse_calibration_request(R"({"do": "answer"})"));
  EXPECT_FALSE(parse_calibration_request(R"({"do": "start", "text": "12.5"})"));
  EXPECT_FALSE(parse_calibration_request(R"({"do": "answer", "text": "", "quick": true})"));
  for (const char* const bad :
       {"", "[]", "{}", R"({"do": 1})", R"({"do": "stop"})", R"({"do": "start", "quick": true})",
        R"({"do": "start", "fast": true})", R"({"do": "restore", "quick": true})"}) {
    EXPECT_FALSE(parse_calibration_request(bad)) << bad;
  }
}

}  // namespace
}  // namespace cyclorama::operations

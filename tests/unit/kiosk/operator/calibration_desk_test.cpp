// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/calibration_desk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/doubles/fake_calibrator.h"

namespace cyclorama {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

struct Desk {
  FakeCalibrator calibrator;
  std::unique_ptr<CalibrationDesk> desk;

  Desk() {
    auto made = CalibrationDesk::make(calibrator.address());
    CHECK(made);
    desk = *std::move(made);
  }
  [[nodiscard]] nlohmann::json now() const { return nlohmann::json::parse(desk->json()); }
  /// Returns the first answer with a state other than "running".
  [[nodiscard]] nlohmann::json end() const {
    const TimePoint deadline = SteadyClock().now() + 20s;
    while (now()["state"] == "running" && SteadyClock().now() < deadline) std::this_thread::yield();
    return now();
  }
};

TEST(CalibrationDesk, tells_how_a_calibration_went) {
  Desk desk;
  EXPECT_EQ(desk.now()["state"], "idle");
  ASSERT_TRUE(desk.desk->start({}));
  const auto end = desk.end();
  EXPECT_EQ(end["state"], "done");
  EXPECT_EQ(end["fraction"], 1.0);
  EXPECT_EQ(end["date"], "2026-11-22");
  EXPECT_EQ(end["remarks"].size(), 1u);
  EXPECT_EQ(desk.desk->picture(), "a picture");
  EXPECT_TRUE(desk.desk->start({})) << "and again";
}

TEST(CalibrationDesk, cancels_and_runs_one_at_a_time) {
  Desk desk;
  desk.calibrator.is_held = true;
  ASSERT_TRUE(desk.desk->start({}));
  const Status second = desk.desk->start({});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code(), ErrorCode::kBusy);
  EXPECT_FALSE(desk.desk->restore()) << "not while one runs";
  desk.desk->cancel();
  EXPECT_EQ(desk.end()["state"], "cancelled");
  desk.desk->cancel();
  desk.calibrator.is_held = false;
  ASSERT_TRUE(desk.desk->start({}));
  EXPECT_EQ(desk.end()["state"], "done");
}

TEST(CalibrationDesk, says_why_one_failed) {
  Desk desk;
  desk.calibrator.messages.resize(1);
  desk.calibrator.end = to_grpc(Error(ErrorCode::kUnavailable, "projector 'left' is dark; switch it on"));
  ASSERT_TRUE(desk.desk->start({}));
  const auto end = desk.end();
  EXPECT_EQ(end["state"], "failed");
  EXPECT_THAT(end["error"].get<std::string>(), HasSubstr("projector 'left' is dark; switch it on"));
}

TEST(CalibrationDesk, says_that_nobody_calibrates_here) {
  auto desk = CalibrationDesk::make("[::1]:1");
  ASSERT_TRUE(desk);
  ASSERT_TRUE((*desk)->start({}));
  const TimePoint deadline = SteadyClock().now() + 20s;
  while (nlohmann::json::parse((*desk)->json())["state"] == "running" && SteadyClock().now() < deadline)
    std::this_thread::yield();
  EXPECT_EQ(nlohmann::json::parse((*desk)->json())["state"], "failed");
  EXPECT_FALSE((*desk)->restore());
}

TEST(CalibrationDesk, has_the_fixed_cameras_placed) {
  Desk desk;
  EXPECT_EQ(desk.now()["what"], "wall");
  ASSERT_TRUE(desk.desk->place_cameras());
  const auto end = desk.end();
  EXPECT_EQ(end["what"], "cameras");
  EXPECT_EQ(end["state"], "done") << end;
  ASSERT_EQ(end["remarks"].size(), 2u);
  EXPECT_THAT(end["remarks"][0].get<std::string>(), HasSubstr("Camera 'left' saw 2814 places of the wall"));
  EXPECT_THAT(end["remarks"][1].get<std::string>(), HasSubstr("turn it to the wall"));
  desk.calibrator.healing.is_placing = true;
  ASSERT_TRUE(desk.desk->place_cameras());
  const Status second = desk.desk->start({});
  ASSERT_FALSE(second) << "the wall is measured by one at a time";
  EXPECT_EQ(second.error().code(), ErrorCode::kBusy);
  desk.desk->cancel();
  EXPECT_EQ(desk.end()["state"], "cancelled");
  desk.calibrator.healing.is_placing = false;
  desk.calibrator.healing.is_watching = false;
  ASSERT_TRUE(desk.desk->place_cameras());
  EXPECT_THAT(desk.end()["error"].get<std::string>(), HasSubstr("name one in calibrator.toml"));
  ASSERT_TRUE(desk.desk->start({}));
  EXPECT_EQ(desk.end()["what"], "wall");
}

TEST(CalibrationDesk, brings_the_one_of_before_back) {
  Desk desk;
  const auto date = desk.desk->restore();
  ASSERT_TRUE(date);
  EXPECT_EQ(*date, "2026-10-01");
  desk.calibrator.restored_date.clear();
  const auto none = desk.desk->restore();
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code(), ErrorCode::kNotFound);
}

TEST(CalibrationDesk, ends_at_once_with_a_calibration_that_runs) {
  Desk desk;
  desk.calibrator.is_held = true;
  ASSERT_TRUE(desk.desk->start({}));
  const TimePoint deadline = SteadyClock().now() + 20s;
  while (desk.desk->picture().empty() && SteadyClock().now() < deadline) std::this_thread::yield();
  desk.desk.reset();
  EXPECT_TRUE(desk.calibrator.wait_for_cancel());
}

TEST(CalibrationWish, is_read_strictly) {
  const auto start = parse_calibration_wish(R"({"do": "start", "quick": true, "projector": "left", "resume": false})");
  ASSERT_TRUE(start);
  EXPECT_TRUE(start->order.quick());
  EXPECT_EQ(start->order.projector(), "left");
  EXPECT_EQ(parse_calibration_wish(R"({"do": "cancel"})")->kind, CalibrationWish::Kind::kCancel);
  EXPECT_EQ(parse_calibration_wish(R"({"do": "place-cameras"})")->kind, CalibrationWish::Kind::kPlaceCameras);
  EXPECT_FALSE(parse_calibration_wish(R"({"do": "place-cameras", "quick": true})"));
  const auto answer = parse_calibration_wish(R"({"do": "answer", "text": "12.5"})");
  EXPECT_EQ(answer->kind, CalibrationWish::Kind::kAnswer);
  EXPECT_EQ(answer->text, "12.5");
  EXPECT_FALSE(parse_calibration_wish(R"({"do": "answer"})"));
  EXPECT_FALSE(parse_calibration_wish(R"({"do": "start", "text": "12.5"})"));
  EXPECT_FALSE(parse_calibration_wish(R"({"do": "answer", "text": "", "quick": true})"));
  for (const char* const bad :
       {"", "[]", "{}", R"({"do": 1})", R"({"do": "stop"})", R"({"do": "start", "quick": true})",
        R"({"do": "start", "fast": true})", R"({"do": "restore", "quick": true})"}) {
    EXPECT_FALSE(parse_calibration_wish(bad)) << bad;
  }
}

}  // namespace
}  // namespace cyclorama

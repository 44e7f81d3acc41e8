// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/status_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "kiosk/operator/metrics.h"
#include "kiosk/operator/status_table.h"

namespace cyclorama::operations {
namespace {

using testing::HasSubstr;
using testing::Not;

ProcessObservation seen(const std::string& name, wire::ProcessStatus status) {
  ProcessObservation observation;
  observation.endpoint = {name, "[::1]:1"};
  observation.asked = true;
  observation.away = false;
  observation.sentence = status.state();
  observation.status = std::move(status);
  return observation;
}

wire::ProcessStatus odd_status() {
  wire::ProcessStatus status;
  status.set_healthy(true);
  status.set_state("quote \" backslash \\ \xff bytes");
  auto* const gauge = status.add_gauges();
  gauge->set_name("dropped: \"late\"\n");
  gauge->set_value(3);
  auto* const nan = status.add_gauges();
  nan->set_name("heading_deg");
  nan->set_value(std::numeric_limits<double>::quiet_NaN());
  auto* const stage = status.add_stages();
  stage->set_name("render");
  stage->set_p50_ms(20);
  stage->set_count(7);
  return status;
}

TEST(StatusJson, is_valid_json_for_any_text_of_a_process) {
  const std::string text = status_json({seen("tour", odd_status())});
  const auto json = nlohmann::json::parse(text, nullptr, false);
  ASSERT_FALSE(json.is_discarded()) << text;
  EXPECT_TRUE(json["processes"][0]["gauges"]["heading_deg"].is_null());
  EXPECT_EQ(json["flow"][0]["inside"], "farm");
  EXPECT_EQ(json["flow"][0]["where"], "farm");
}

TEST(StatusJson, is_healthy_only_when_every_process_is) {
  ProcessObservation away;
  away.endpoint = {"display", "[::1]:2"};
  away.asked = true;
  EXPECT_THAT(status_json({seen("tour", odd_status())}), HasSubstr("\"well\": true"));
  EXPECT_THAT(status_json({seen("tour", odd_status()), away}), HasSubstr("\"well\": false"));
}

TEST(Steer, accepts_any_of_three_numbers) {
  const auto wanted = parse_steer(R"({"forward": -1, "right": 0.25})");
  ASSERT_TRUE(wanted);
  EXPECT_EQ(wanted->forward(), -1.0);
  EXPECT_EQ(wanted->right(), 0.25);
  EXPECT_EQ(wanted->turn(), 0.0);
  EXPECT_TRUE(parse_steer("{}"));
}

TEST(Steer, refuses_everything_else_by_name) {
  for (const char* const text :
       {"", "null", "[]", "3", "{", R"({"forward": "1"})", R"({"forward": 1.0001})", R"({"forward": 1e999})",
        R"({"forward": null})", R"({"turn": [1]})", R"({"up": 1})", "\xff\xfe", R"({"forward": NaN})"}) {
    const auto wanted = parse_steer(text);
    ASSERT_FALSE(wanted) << text;
    EXPECT_EQ(wanted.error().code(), ErrorCode::kBadData);
  }
  EXPECT_THAT(parse_steer(R"({"up": 1})").error().message(), HasSubstr("'up'"));
  EXPECT_THAT(parse_steer(R"({"turn": 2})").error().message(), HasSubstr("'turn'"));
}

TEST(Metrics, are_valid_prometheus_text_for_any_text_of_a_process) {
  const std::string text = metrics_text({seen("tour", odd_status())});
  EXPECT_THAT(text, HasSubstr("cyclorama_dropped_frames_total{process=\"tour\",reason=\"\\\"late\\\"\\n\"} 3\n"));
  EXPECT_THAT(text, HasSubstr("cyclorama_stage_seconds{process=\"tour\",stage=\"render\",quantile=\"0.5\"} 0.02\n"));
  EXPECT_THAT(text, HasSubstr("cyclorama_stage_seconds_count{process=\"tour\",stage=\"render\"} 7\n"));
  EXPECT_THAT(text, HasSubstr("cyclorama_gauge{process=\"tour\",name=\"heading_deg\"} NaN\n"));
}

TEST(Metrics, have_no_old_values_of_an_absent_process) {
  ProcessObservation gone = seen("tour", odd_status());
  gone.away = true;
  const std::string text = metrics_text({gone});
  EXPECT_THAT(text, HasSubstr("cyclorama_up{process=\"tour\"} 0\n"));
  EXPECT_THAT(text, Not(HasSubstr("cyclorama_stage_seconds{")));
}

TEST(StatusTable, has_a_line_for_each_part_and_stage) {
  const std::string table = status_table({seen("tour", odd_status())});
  EXPECT_THAT(table, HasSubstr("tour            well"));
  EXPECT_THAT(table, HasSubstr("render"));
}

}  // namespace
}  // namespace cyclorama::operations

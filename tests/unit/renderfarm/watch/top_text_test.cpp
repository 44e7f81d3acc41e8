// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/watch/top_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "renderfarm/watch/farm_tables.h"
#include "renderfarm/watch/status_json.h"

namespace cyclorama::watch {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::StartsWith;

wire::ProcessStatus status_of_a_farm() {
  FarmOverview farm;
  farm.sessions = {{1, "Hall 3", "grotto", 20.04, 4, 0.75, 1920, 480, 50.0, 47.0, 3e5, 0.97, 812, 3, 1, 0},
                   {2, "Musée de la préhistoire, grande salle", "relic"}};
  farm.nodes = {
      {7, "render-07", "ready", 8, 1.0, 3, 2, std::uint64_t{2} << 30, 60.0, 0.98, {"grotto", "relic"}, {"cave: 42 %"}}};
  wire::ProcessStatus status;
  status.set_process("coordinator");
  status.set_version("1.2.3");
  status.set_uptime_s(7300.0);
  status.set_state("2 sessions on 1 nodes");
  status.set_healthy(true);
  *status.add_tables() = sessions_table(farm);
  *status.add_tables() = nodes_table(farm);
  for (const char* const name : {"farm", "plan", "mystery", "relay"}) {
    wire::Stage* const stage = status.add_stages();
    stage->set_name(name);
    stage->set_count(812);
    stage->set_p50_ms(0.25);
    stage->set_p99_ms(0.75);
  }
  return status;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::size_t characters(const std::string& line) {
  return static_cast<std::size_t>(std::ranges::count_if(line, [](char c) { return (c & 0xc0) != 0x80; }));
}

TEST(TopText, shows_sessions_nodes_and_steps_in_the_order_of_a_frame) {
  const auto lines = lines_of(top_text(status_of_a_farm(), 200));
  ASSERT_EQ(lines.size(), 15u);
  EXPECT_EQ(lines[0], "cyclorama-farm 1.2.3, up 2 h: 2 sessions on 1 nodes");
  EXPECT_THAT(lines[4], ContainsRegex("^Hall 3 +grotto +20\\.0 +4 +0\\.75 +50 +47\\.0 +300 +0\\.97 +1 +0 +812$"));
  EXPECT_THAT(lines[8], ContainsRegex("^render-07 +ready +8 +1\\.00 +0\\.98 +3 +2 +2147 +grotto, relic +cave: 42 %$"));
  EXPECT_THAT(lines[10], HasSubstr("p99 ms"));
  EXPECT_THAT(lines[11], ContainsRegex("^plan +0\\.25 +0\\.00 +0\\.75 +812$"));
  EXPECT_THAT(lines[12], StartsWith("relay"));
  EXPECT_THAT(lines[14], StartsWith("mystery"));
}

TEST(TopText, fits_the_terminal_and_aligns_columns) {
  for (const int columns : {1, 20, 80, 200}) {
    for (const std::string& line : lines_of(top_text(status_of_a_farm(), columns))) {
      EXPECT_LE(characters(line), static_cast<std::size_t>(columns)) << line;
    }
  }
  const auto lines = lines_of(top_text(status_of_a_farm(), 200));
  EXPECT_EQ(characters(lines[4]), characters(lines[5])) << "accents are one character wide";
}

TEST(TopText, reports_an_empty_farm) {
  wire::ProcessStatus status;
  status.set_state("no node is connected");
  const std::string text = top_text(status, 100);
  EXPECT_THAT(text, HasSubstr("NOT WELL: no node is connected"));
  EXPECT_THAT(text, HasSubstr("(none)"));
}

TEST(StatusJson, has_the_tables_under_their_names) {
  const auto json = nlohmann::json::parse(status_json(status_of_a_farm()));
  EXPECT_EQ(json["sessions"][0]["museum"], "Hall 3");
  EXPECT_EQ(json["sessions"][0]["id"].dump(), "1");
  EXPECT_EQ(json["sessions"][0]["scale"].dump(), "0.75");
  EXPECT_EQ(json["sessions"][0]["late_frames"], 1);
  EXPECT_EQ(json["nodes"][0]["scenes"], "grotto, relic");
  EXPECT_EQ(json["stages"]["plan"]["p99_ms"], 0.75);
  EXPECT_EQ(json["healthy"], true);
  EXPECT_EQ(nlohmann::json::parse(table_json(status_of_a_farm(), "sessions")).size(), 2u);
  EXPECT_EQ(nlohmann::json::parse(table_json(status_of_a_farm(), "none")), nlohmann::json::array());
}

TEST(StatusJson, survives_invalid_utf8_invalid_numbers_and_short_rows) {
  wire::ProcessStatus status;
  wire::Table* const table = status.add_tables();
  table->set_name("sessions");
  table->add_columns("museum");
  table->add_columns("scale");
  table->add_rows()->add_cells()->set_text("\"");
  wire::Row* const row = table->add_rows();
  row->add_cells();
  row->add_cells()->set_number(std::nan(""));
  row->add_cells()->set_number(1);
  const auto json = nlohmann::json::parse(status_json(status));
  EXPECT_EQ(json["sessions"][0], (nlohmann::json{{"museum", "\""}}));
  EXPECT_EQ(json["sessions"][1], (nlohmann::json{{"museum", nullptr}, {"scale", nullptr}}));
}

}  // namespace
}  // namespace cyclorama::watch

// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/watch/farm_metrics.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "common/base/file.h"
#include "tests/support/prometheus_text.h"

namespace cyclorama::watch {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Key;
using testing::Not;
using Outcome = FrameFigures::Outcome;

FarmOverview small_farm() {
  FarmOverview farm;
  farm.healthy = true;
  farm.scene_nodes = {{"grotto", 2}};
  farm.sessions = {{1, "Hall 3", "grotto", 20.0, 4, 0.75, 1920, 480, 50.0, 47.0, 3e5, 0.97},
                   {2, "Hall 3", "grotto", 20.0, 16, 1.0, 1920, 480, 40.0, 41.0, 2e5, 0.99}};
  farm.nodes = {{7, "render-07", "ready", 8, 1.0, 3, 2, std::uint64_t{1} << 31, 60.0, 0.98, {"grotto"}},
                {9, "render-07", "late", 4, 0.5, 1, 0, 1000, 6.0, 0.5, {}}};
  return farm;
}

TEST(FarmMetrics, counts_frames_by_museum_and_outcome) {
  FarmMetrics metrics;
  metrics.session_opened("Hall 3");
  metrics.add({"Hall 3", Outcome::kWhole, 1000, 50, true, 2});
  metrics.add({"Hall 3", Outcome::kWhole, 1000, 50, false, 0});
  metrics.add({"Hall 3", Outcome::kLate, 10, 5, false, 0});
  const auto samples = samples_of(metrics.text());
  EXPECT_EQ(samples.at("cyclorama_frames_total{museum=\"Hall 3\"}"), 2);
  EXPECT_EQ(samples.at("cyclorama_frames_late_total{museum=\"Hall 3\"}"), 1);
  EXPECT_EQ(samples.at("cyclorama_frames_given_up_total{museum=\"Hall 3\"}"), 0) << "a rate needs a first value";
  EXPECT_EQ(samples.at("cyclorama_frame_bytes_total{museum=\"Hall 3\"}"), 2010);
  EXPECT_EQ(samples.at("cyclorama_rays_total"), 105);
  EXPECT_EQ(samples.at("cyclorama_frames_given_again_total"), 1);
  EXPECT_EQ(samples.at("cyclorama_blocks_moved_total"), 2);
}

TEST(FarmMetrics, records_each_step_of_a_frame_in_a_histogram) {
  FarmMetrics metrics;
  metrics.add_stage("plan", 0.0004);
  metrics.add_stage("plan", 0.7);
  const auto samples = samples_of(metrics.text());
  EXPECT_EQ(samples.at("cyclorama_frame_seconds_count{stage=\"plan\"}"), 2);
  EXPECT_EQ(samples.at("cyclorama_frame_seconds_bucket{stage=\"plan\",le=\"0.001\"}"), 1);
  EXPECT_EQ(samples.at("cyclorama_frame_seconds_bucket{stage=\"plan\",le=\"+Inf\"}"), 2);
  EXPECT_DOUBLE_EQ(samples.at("cyclorama_frame_seconds_sum{stage=\"plan\"}"), 0.7004);
}

TEST(FarmMetrics, shows_the_worst_session_of_a_museum_and_numbers_nodes_of_the_same_name) {
  FarmMetrics metrics;
  metrics.show(small_farm());
  const auto samples = samples_of(metrics.text());
  EXPECT_EQ(samples.at("cyclorama_sessions{museum=\"Hall 3\"}"), 2);
  EXPECT_EQ(samples.at("cyclorama_session_samples_per_pixel{museum=\"Hall 3\"}"), 4);
  EXPECT_DOUBLE_EQ(samples.at("cyclorama_session_frame_seconds{museum=\"Hall 3\"}"), 0.047);
  EXPECT_DOUBLE_EQ(samples.at("cyclorama_session_balance_efficiency_ratio{museum=\"Hall 3\"}"), 0.97);
  EXPECT_EQ(samples.at("cyclorama_nodes"), 2);
  EXPECT_EQ(samples.at("cyclorama_node_memory_bytes{node=\"render-07\"}"), 2147483648.0);
  EXPECT_EQ(samples.at("cyclorama_node_late{node=\"render-07 #2\"}"), 1);
  EXPECT_EQ(samples.at("cyclorama_node_ready{node=\"render-07\"}"), 1);
  EXPECT_EQ(samples.at("cyclorama_scene_nodes{scene=\"grotto\"}"), 2);
}

TEST(FarmMetrics, removed_sessions_and_nodes_leave_no_samples) {
  FarmMetrics metrics;
  metrics.show(small_farm());
  metrics.show({});
  const auto samples = samples_of(metrics.text());
  EXPECT_EQ(samples.at("cyclorama_nodes"), 0);
  EXPECT_THAT(samples, Not(Contains(Key(HasSubstr("render-07")))));
  EXPECT_THAT(samples, Not(Contains(Key(HasSubstr("Hall 3")))));
}

TEST(FarmMetrics, escapes_a_museums_name) {
  FarmMetrics metrics;
  metrics.add({"a\"} 1\nb\\c", Outcome::kWhole, 1, 1, false, 0});
  metrics.add({"", Outcome::kWhole, 1, 1, false, 0});
  const auto samples = samples_of(metrics.text());
  EXPECT_EQ(samples.at(R"(cyclorama_frames_total{museum="a\"} 1\nb\\c"})"), 1);
  EXPECT_EQ(samples.at("cyclorama_frames_total{museum=\"(unnamed)\"}"), 1);
}

TEST(FarmMetrics, museums_beyond_the_limit_share_one_series) {
  FarmMetrics metrics;
  for (std::size_t i = 0; i < FarmMetrics::kMaxMuseums + 10; ++i) {
    metrics.add({fmt::format("museum {}", i), Outcome::kWhole, 1, 1, false, 0});
  }
  FarmOverview farm;
  farm.sessions = {{1, "another", "grotto"}, {2, "museum 70", "grotto"}, {3, "museum 1", "grotto"}};
  metrics.show(farm);
  const auto samples = samples_of(metrics.text());
  EXPECT_EQ(samples.at("cyclorama_frames_total{museum=\"(others)\"}"), 10);
  EXPECT_EQ(samples.at("cyclorama_sessions{museum=\"(others)\"}"), 2);
  EXPECT_EQ(samples.at("cyclorama_sessions{museum=\"museum 1\"}"), 1);
}

TEST(FarmMetrics, counts_the_bytes_of_scenes_once) {
  FarmMetrics metrics;
  EXPECT_EQ(samples_of(metrics.text()).at("cyclorama_scene_bytes_sent_total"), 0);
  for (const std::uint64_t so_far : {1'000'000u, 1'000'000u, 3'500'000u}) metrics.scene_bytes_sent(so_far);
  EXPECT_EQ(samples_of(metrics.text()).at("cyclorama_scene_bytes_sent_total"), 3'500'000);
}

TEST(FarmMetrics, counts_refused_sessions_by_reason) {
  FarmMetrics metrics;
  metrics.session_refused(ErrorCode::kBusy);
  metrics.session_refused(ErrorCode::kBusy);
  metrics.node_sent_away();
  const auto samples = samples_of(metrics.text());
  EXPECT_EQ(samples.at("cyclorama_sessions_refused_total{reason=\"full\"}"), 2);
  EXPECT_EQ(samples.at("cyclorama_nodes_sent_away_total"), 1);
}

/// Adds one sample to each family, so that all are exposed.
std::set<std::string> all_families() {
  FarmMetrics metrics;
  metrics.session_opened("Hall 3");
  metrics.session_refused(ErrorCode::kBusy);
  metrics.add_stage("plan", 0.001);
  metrics.add({"Hall 3", Outcome::kWhole, 1, 1, false, 0});
  metrics.show(small_farm());
  std::set<std::string> names;
  for (const auto& [sample, value] : samples_of(metrics.text())) {
    names.insert(std::regex_replace(sample.substr(0, sample.find('{')), std::regex("_(bucket|sum|count)$"), ""));
  }
  return names;
}

std::string document(const char* path) {
  const char* const source = std::getenv("CYCLORAMA_SOURCE");  // NOLINT(concurrency-mt-unsafe): nobody sets it.
  auto text = read_text_file(std::filesystem::path(source == nullptr ? "." : source) / path, 1 << 20);
  CHECK(text);
  return *std::move(text);
}

std::set<std::string> names_in(const std::string& text) {
  static const std::regex kName("cyclorama_[a-z_]+");
  std::set<std::string> names;
  for (std::sregex_iterator name(text.begin(), text.end(), kName), end; name != end; ++name) {
    names.insert(std::regex_replace(name->str(), std::regex("_bucket$"), ""));
  }
  return names;
}

TEST(FarmMetrics, the_dashboard_uses_existing_metrics_only) {
  const auto dashboard = nlohmann::json::parse(document("docs/reference/dashboard.json"));
  std::set<std::string> asked;
  int queries = 0;
  for (const auto& panel : dashboard["panels"]) {
    for (const auto& target : panel["targets"]) {
      ++queries;
      asked.merge(names_in(target["expr"].get<std::string>()));
    }
  }
  EXPECT_GE(queries, 20);
  EXPECT_THAT(asked, testing::Each(testing::AnyOfArray(all_families())));
}

TEST(FarmMetrics, the_operators_page_lists_exactly_the_existing_metrics) {
  EXPECT_EQ(names_in(document("docs/reference/metrics.md")), all_families());
}

}  // namespace
}  // namespace cyclorama::watch

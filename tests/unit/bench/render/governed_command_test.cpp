// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/governed_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/base/file.h"

namespace cyclorama::render {
namespace {

class GovernedCommand : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) / ("governed_command_test_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
    ASSERT_TRUE(write_file_atomically(folder_ / "roof.obj",
                                      std::string_view("v -1 0 -1\nv 1 0 -1\nv 0 1 1\nv 0 -1 1\nf 1 2 3\nf 2 1 4\n")));
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  Status governed(std::vector<std::string> options) {
    CLI::App program;
    const tools::RenderCommand command = add_governed_command(&program);
    options.insert(options.begin(), {"governed", (folder_ / "roof.obj").string(), "--size", "32x16", "--threads", "1",
                                     "--frames", "30", "--reference-samples", "64", "--json", json()});
    std::ranges::reverse(options);  // CLI11 takes them from the back.
    program.parse(options);
    return command.run(StopSignal());
  }
  std::string json() { return (folder_ / "out.json").string(); }
  std::filesystem::path folder_;
};

TEST_F(GovernedCommand, reports_the_result_of_each_budget_and_how_the_error_falls_at_rest) {
  const Status status = governed({"--budgets", "5,200"});
  ASSERT_TRUE(status) << status.error().message();
  const auto text = read_text_file(json(), 1 << 20);
  ASSERT_TRUE(text);
  const nlohmann::json figures = nlohmann::json::parse(*text);
  ASSERT_EQ(figures["points"].size(), 2u);
  EXPECT_EQ(figures["points"][0]["budget_ms"], 5.0);
  for (const nlohmann::json& point : figures["points"]) {
    EXPECT_GT(point["bytes"], 100);
    EXPECT_GE(point["flip"], 0.0);
    EXPECT_GE(point["relmse"], 0.0);
    EXPECT_GE(point["ms_p95"], point["ms_p50"]);
  }
  EXPECT_THAT(figures["still"]["samples"].get<std::vector<int>>(), testing::ElementsAre(1, 2, 4, 8));
  EXPECT_LT(figures["still"]["slope"], 0.0);
}

TEST_F(GovernedCommand, uses_a_given_pareto_front_or_reports_why_not) {
  EXPECT_FALSE(governed({"--front", (folder_ / "none.toml").string()}));
  ASSERT_TRUE(write_file_atomically(folder_ / "pareto_front.toml",
                                    std::string_view("[[point]]\ncpu_us_per_px = 1.0\nerror = 0.5\nsamples = 3\n")));
  ASSERT_TRUE(governed({"--budgets", "50", "--front", (folder_ / "pareto_front.toml").string()}));
  const auto text = read_text_file(json(), 1 << 20);
  ASSERT_TRUE(text);
  EXPECT_EQ(nlohmann::json::parse(*text)["points"][0]["samples"], 3);
}

}  // namespace
}  // namespace cyclorama::render

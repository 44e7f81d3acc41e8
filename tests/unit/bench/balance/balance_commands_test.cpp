// SPDX-License-Identifier: Apache-2.0
// Tests `record`, then `replay` and `figure9` of its output.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/base/file.h"
#include "renderfarm/balance/balancer.h"
#include "renderfarm/balance/cost_record.h"
#include "tests/bench/balance/figure9_command.h"
#include "tests/bench/balance/record_command.h"
#include "tests/bench/balance/replay_command.h"

namespace cyclorama::balance {
namespace {

using testing::HasSubstr;

class BalanceCommands : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) / ("balance_commands_test_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
    ASSERT_TRUE(write_file_atomically(folder_ / "roof.obj",
                                      std::string_view("v -1 0 -1\nv 1 0 -1\nv 0 1 1\nv 0 -1 1\nf 1 2 3\nf 2 1 4\n")));
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string file(const std::string& name) { return (folder_ / name).string(); }

  static Status run(std::vector<std::string> line) {
    CLI::App program;
    const std::array commands{add_record_command(&program), add_replay_command(&program),
                              add_figure9_command(&program)};
    std::ranges::reverse(line);  // CLI11 takes them from the back.
    program.parse(line);
    for (const tools::RenderCommand& command : commands) {
      if (command.parser->parsed()) return command.run(StopSignal());
    }
    return Error(ErrorCode::kInvalidArgument, "no command");
  }
  Status record(const std::string& path, const std::string& out) {
    return run({"record", file("roof.obj"), "--size", "96x48", "--frames", "4", "--samples", "1", "--threads", "1",
                "--path", path, "--out", out});
  }
  nlohmann::json json() {
    const auto text = read_text_file(file("out.json"), 1 << 20);
    return text ? nlohmann::json::parse(*text) : nlohmann::json();
  }
  std::filesystem::path folder_;
};

TEST_F(BalanceCommands, record_the_cost_of_every_cell_of_every_frame) {
  for (const std::string path : {"orbit", "walk"}) {
    const Status status = record(path, file(path + ".costs"));
    ASSERT_TRUE(status) << status.error().message();
    const auto frames = read_cost_record(file(path + ".costs"));
    ASSERT_TRUE(frames);
    ASSERT_EQ(frames->size(), 4u);
    for (const RecordedFrame& frame : *frames) {
      EXPECT_EQ(frame.work.size(), (PictureSize{96, 48}));
      EXPECT_TRUE(std::ranges::all_of(frame.work.cells(), [](float work) { return work > 0.0f; }));
    }
  }
  EXPECT_NE((*read_cost_record(file("orbit.costs")))[1].heading_rad,
            (*read_cost_record(file("orbit.costs")))[0].heading_rad);
}

TEST_F(BalanceCommands, replay_every_strategy_and_number_of_nodes) {
  ASSERT_TRUE(record("orbit", file("a.costs")));
  const Status status = run({"replay", file("a.costs"), "--nodes", "2,4", "--unequal", "--json", file("out.json")});
  ASSERT_TRUE(status) << status.error().message();
  const nlohmann::json rows = json();
  ASSERT_EQ(rows.size(), 2 * (kBalanceStrategies.size() + 1));
  for (const nlohmann::json& row : rows) {
    EXPECT_GT(row["mean"], 0.0);
    EXPECT_LE(row["mean"], 1.0 + 1e-6);
    EXPECT_LE(row["p5"], 1.0 + 1e-6);
    if (row["strategy"] == "equal") {
      EXPECT_NEAR(row["gain"], 0.0, 1e-9);
      EXPECT_EQ(row["below_equal"], 0);
    }
  }
  ASSERT_TRUE(run({"replay", file("a.costs"), "--nodes", "4", "--strategy", "pbt,oracle", "--json", file("out.json")}));
  EXPECT_EQ(json().size(), 2u);
}

TEST_F(BalanceCommands, draw_figure_9) {
  ASSERT_TRUE(record("orbit", file("a.costs")));
  ASSERT_TRUE(run({"figure9", "small=" + file("a.costs"), "large=" + file("a.costs"), "--nodes", "1,4", "--svg",
                   file("figure9.svg"), "--json", file("out.json")}));
  EXPECT_EQ(json().size(), 8u);
  const auto svg = read_text_file(file("figure9.svg"), 1 << 20);
  ASSERT_TRUE(svg);
  EXPECT_THAT(*svg, HasSubstr("frames per second, cost-map-stealing"));
}

TEST_F(BalanceCommands, report_mistakes) {
  EXPECT_EQ(run({"replay", file("none.costs")}).error().code(), ErrorCode::kNotFound);
  EXPECT_EQ(run({"replay", file("roof.obj")}).error().code(), ErrorCode::kBadData);
  EXPECT_THAT(run({"figure9", file("a.costs")}).error().message(), HasSubstr("NAME=FILE"));
  ASSERT_TRUE(record("orbit", file("a.costs")));
  EXPECT_EQ(record("orbit", file("a.costs")).error().code(), ErrorCode::kBusy);
}

}  // namespace
}  // namespace cyclorama::balance

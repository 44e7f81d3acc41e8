// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/trade_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "common/base/file.h"
#include "common/image/pfm.h"
#include "renderfarm/governor/pareto_front_file.h"

namespace cyclorama::render {
namespace {

using testing::HasSubstr;

class TradeCommand : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) / ("trade_command_test_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
    ASSERT_TRUE(write_file_atomically(folder_ / "roof.obj",
                                      std::string_view("v -1 0 -1\nv 1 0 -1\nv 0 1 1\nv 0 -1 1\nf 1 2 3\nf 2 1 4\n")));
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  Status trade(const std::vector<std::string>& options) {
    CLI::App program;
    const tools::RenderCommand command = add_trade_command(&program);
    std::vector<std::string> arguments = options;
    for (const std::string& more :
         {(folder_ / "out").string(), std::string("--out"), (folder_ / "roof.obj").string(), std::string("trade")}) {
      arguments.push_back(more);  // CLI11 takes them from the back.
    }
    program.parse(arguments);
    return command.run(StopSignal());
  }
  std::string text(const char* name) {
    const auto result = read_text_file(folder_ / "out" / name, 1 << 20);
    return result ? *result : "";
  }
  std::filesystem::path folder_;
};

TEST_F(TradeCommand, writes_a_table_a_plot_and_a_pareto_front_for_the_governor) {
  const Status status = trade({"1", "--threads", "8", "--reference-samples", "32x16", "--size", "--quick"});
  ASSERT_TRUE(status) << status.error().message();
  EXPECT_GT(std::ranges::count(text("trade.csv"), '\n'), 20);
  EXPECT_THAT(text("trade.svg"), HasSubstr("roof.obj, 32x16"));
  const auto front = governor::read_pareto_front(folder_ / "out/pareto_front.toml");
  ASSERT_TRUE(front) << front.error().message();
  EXPECT_THAT(text("reference.txt"), HasSubstr("8 samples"));
}

TEST_F(TradeCommand, reuses_the_reference_until_its_settings_change) {
  const auto reference = [&] { return std::filesystem::last_write_time(folder_ / "out/reference.pfm"); };
  ASSERT_TRUE(trade({"1", "--threads", "8", "--reference-samples", "32x16", "--size", "--quick"}));
  const auto first = reference();
  ASSERT_TRUE(trade({"1", "--threads", "8", "--reference-samples", "32x16", "--size", "--quick"}));
  EXPECT_EQ(reference(), first);
  ASSERT_TRUE(trade({"1", "--threads", "9", "--reference-samples", "32x16", "--size", "--quick"}));
  EXPECT_NE(reference(), first);
}

TEST_F(TradeCommand, renders_a_new_reference_when_the_scenes_file_changes) {
  const auto run = [&] { return trade({"1", "--threads", "8", "--reference-samples", "32x16", "--size", "--quick"}); };
  ASSERT_TRUE(run());
  const std::string settings = text("reference.txt");
  ASSERT_TRUE(write_file_atomically(folder_ / "roof.obj",
                                    std::string_view("v -1 0 -1\nv 1 0 -1\nv 0 1.5 1\nv 0 -1 1\nf 1 2 3\nf 2 1 4\n")));
  ASSERT_TRUE(run());
  EXPECT_NE(text("reference.txt"), settings);
}

TEST_F(TradeCommand, renders_a_new_reference_if_it_is_truncated_missing_or_of_another_size) {
  const std::filesystem::path file = folder_ / "out/reference.pfm";
  const auto run = [&] { return trade({"1", "--threads", "8", "--reference-samples", "32x16", "--size", "--quick"}); };
  ASSERT_TRUE(run());
  const std::string settings = text("reference.txt");
  std::filesystem::resize_file(file, 100);
  EXPECT_TRUE(run());
  EXPECT_EQ(read_pfm(file, 1000)->width(), 32);
  std::filesystem::remove(file);
  EXPECT_TRUE(run());
  EXPECT_EQ(read_pfm(file, 1000)->width(), 32);
  ASSERT_TRUE(write_pfm(file, RadianceImage(8, 4)));
  EXPECT_TRUE(run());
  EXPECT_EQ(read_pfm(file, 1000)->width(), 32);
  EXPECT_EQ(text("reference.txt"), settings);
}

}  // namespace
}  // namespace cyclorama::render

// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/light_process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "common/base/clock.h"
#include "common/base/file.h"
#include "renderfarm/node/light_files.h"

namespace cyclorama::node {
namespace {

using testing::HasSubstr;

std::unique_ptr<LightComputation> shell(const std::string& script) {
  auto process = LightProcess::start({"/bin/sh", "-c", script});
  EXPECT_TRUE(process) << process.error().message();
  return *std::move(process);
}

/// Waits until `is_true`, or fails after a time that only a broken program exceeds.
template <typename Predicate>
void eventually(Predicate is_true) {
  const TimePoint deadline = SteadyClock().now() + std::chrono::seconds(20);
  while (!is_true()) {
    ASSERT_LT(SteadyClock().now(), deadline);
    SteadyClock().wait_until(SteadyClock().now() + std::chrono::milliseconds(2));
  }
}

Status end_of(LightComputation& process) {
  std::optional<Status> result;
  eventually([&] { return (result = process.result()).has_value(); });
  return *result;
}

TEST(LightProcess, reports_progress_and_success) {
  const auto process = shell("echo progress 0.25; echo nonsense; echo progress 7e9; echo progress 0.5; exit 0");
  eventually([&] { return process->done_share() == 0.5; });
  EXPECT_TRUE(end_of(*process));
}

TEST(LightProcess, passes_on_stages_pieces_and_orders) {
  const std::string key(32, 'a');
  const auto process =
      shell("echo stage 3 " + key + " 17 /a folder; echo stage x; echo piece 3 4 sum 99; head -c 1000");
  std::vector<LightEvent> events;
  eventually([&] {
    for (LightEvent& event : process->events()) events.push_back(std::move(event));
    return events.size() == 2;
  });
  const auto& stage = std::get<BegunStage>(events[0]);
  EXPECT_EQ(stage.number, 3u);
  EXPECT_EQ(stage.key, key);
  EXPECT_EQ(stage.pieces, 17u);
  EXPECT_EQ(stage.folder, "/a folder");
  const auto& piece = std::get<TakenPiece>(events[1]);
  EXPECT_EQ(piece.stage, 3u);
  EXPECT_EQ(piece.piece, 4u);
  EXPECT_EQ(piece.sha256, "sum");
  EXPECT_EQ(piece.bytes, 99u);
}

TEST(LightProcess, gives_orders_as_single_messages_and_none_to_a_process_that_has_ended) {
  const auto process = shell("printf 'piece 1 '; head -c 11; echo ' sum 1'");  // "compute 0 5" is 11 bytes.
  process->compute(0, 5);
  EXPECT_TRUE(end_of(*process));
  process->fetched(0, 5);
  EXPECT_TRUE(process->events().empty()) << "'piece 1 compute 0 5 sum 1' is no report";
}

TEST(LightProcess, reports_the_last_error_or_how_it_ended) {
  EXPECT_THAT(end_of(*shell("echo error the disk is full; exit 1")).error().message(), HasSubstr("the disk is full"));
  EXPECT_THAT(end_of(*shell("exit 3")).error().message(), HasSubstr("exit code 3"));
  EXPECT_THAT(end_of(*shell("kill -9 $$")).error().message(), HasSubstr("signal 9"));
  EXPECT_FALSE(LightProcess::start({"/no/such/program"}));
}

TEST(LightProcess, makes_no_progress_while_it_is_paused) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "light_process_steps";
  std::filesystem::remove(file);
  const auto process = shell("while :; do printf x >> '" + file.string() + "'; done");
  const auto size = [&] {
    std::error_code none;
    const auto bytes = std::filesystem::file_size(file, none);
    return none ? 0 : bytes;
  };
  eventually([&] { return size() > 10; });
  process->pause();
  // The signal is delivered to a running process without delay; wait until the file has stopped growing.
  auto before = size();
  eventually([&] { return std::exchange(before, size()) == before; });
  SteadyClock().wait_until(SteadyClock().now() + std::chrono::milliseconds(50));
  EXPECT_EQ(size(), before);
  process->resume();
  eventually([&] { return size() > before; });
}

TEST(LightProcess, killed_halfway_leaves_nothing_half) {
  const std::filesystem::path cache = std::filesystem::path(testing::TempDir()) / "light_process_test";
  std::filesystem::remove_all(cache);
  const LightFiles files(cache);
  const std::filesystem::path file = *files.prepare("scene");
  auto process =
      shell("printf half > '" + file.string() + ".a1B2c3'; echo progress 0.9; read x < /dev/zero; sleep 100");
  eventually([&] { return process->done_share() > 0.0; });
  process.reset();
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_TRUE(files.prepare("scene"));
  LightFiles::remove_left_over(file);
  EXPECT_TRUE(std::filesystem::is_empty(file.parent_path()));
  std::filesystem::remove_all(cache);
}

TEST(LightFiles, lie_in_the_cache_or_else_in_the_scenes_own_folder) {
  const std::filesystem::path scene = std::filesystem::path(testing::TempDir()) / "light_files_scene";
  std::filesystem::create_directories(scene);
  EXPECT_EQ(LightFiles("").file_of(scene.string()), scene / "light.store");
  EXPECT_EQ(LightFiles("").file_of((scene / "scene.ply").string()), "");
  const LightFiles cached("/cache");
  EXPECT_EQ(cached.file_of(scene.string()).parent_path(), "/cache/light");
  EXPECT_NE(cached.file_of("a"), cached.file_of("b"));
  EXPECT_FALSE(cached.prepare("a").has_value() && ::geteuid() != 0);
  std::filesystem::remove_all(scene);
}

}  // namespace
}  // namespace cyclorama::node

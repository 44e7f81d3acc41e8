// SPDX-License-Identifier: Apache-2.0
// Light computed in pieces: by several hosts, in several runs, and from damaged files. The result is the same to the
// bit.
#include "renderfarm/light_baking/light_pieces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <condition_variable>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <thread>

#include "renderfarm/light/light_file.h"
#include "renderfarm/light_baking/grid_pieces.h"
#include "renderfarm/light_baking/piece_folder.h"
#include "tests/unit/renderfarm/light_baking/light_cases.h"

namespace cyclorama::light_baking {
namespace {

using testing::HasSubstr;

namespace fs = std::filesystem;

/// A box whose floor is coarse, with a ball that throws a shadow: all stages have pieces, and there are grids.
std::unique_ptr<render::Renderer> scene_with_shadow() {
  scene::Scene scene = box_scene(0.5f, 24);
  scene::Mesh ball = sphere_mesh(0.3f, 24);
  ball.origin = {0.8, -1.2, 0.2};
  add_mesh(scene, std::move(ball));
  scene.model.lights = {point_light({0.9, 1.5, 0.4}, 20.0f)};
  scene.model.lights[0].radius_m = 0.1;
  scene.exposure = 0.5;
  scene.bounces = 2;
  return built(std::move(scene));
}

BakeSettings fine() {
  BakeSettings settings = quick();
  settings.pixels_per_degree = 8.0;
  settings.coarse_rays = 4;
  settings.final_rays = 16;
  return settings;
}

std::vector<std::byte> bytes_of(const Result<BakedLight>& light) {
  EXPECT_TRUE(light.has_value()) << light.error().message();
  return light ? light::light_file_bytes(*light->store) : std::vector<std::byte>();
}

/// Counts what is computed, and may cancel.
class CountedPieces final : public LightPieces {
 public:
  explicit CountedPieces(LightPieces& pieces) : pieces_(pieces) {}
  Status begin(const std::string& computation) override { return pieces_.begin(computation); }
  Status complete(const LightStage& stage, const StageWork& work) override {
    StageWork counted = work;
    counted.compute = [&](std::uint32_t piece) {
      ++computed;
      return work.compute(piece);
    };
    all += stage.pieces;
    return pieces_.complete(stage, counted);
  }

  std::atomic<std::uint32_t> computed = 0;
  std::uint32_t all = 0;

 private:
  LightPieces& pieces_;
};

class LightPiecesTest : public testing::Test {
 protected:
  LightPiecesTest() { fs::remove_all(folder); }
  ~LightPiecesTest() override { fs::remove_all(folder); }

  struct Run {
    Result<BakedLight> light;
    std::uint32_t computed = 0;
    std::uint32_t all = 0;
  };
  [[nodiscard]] Run run(const std::function<bool()>& cancelled = nullptr, const BakeSettings& settings = fine()) const {
    KeptPieces kept(folder);
    CountedPieces pieces(kept);
    const auto renderer = scene_with_shadow();
    Result<BakedLight> light = bake_light(*renderer, settings, 2, nullptr, cancelled, &pieces);
    return {std::move(light), pieces.computed, pieces.all};
  }
  [[nodiscard]] std::vector<fs::path> files() const {
    std::vector<fs::path> found;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file()) found.push_back(entry.path());
    }
    return found;
  }

  /// Returns true if there are a few files. May be called while they are written.
  [[nodiscard]] bool has_files() const {
    int count = 0;
    std::error_code error;
    for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
      if (at->is_regular_file(error)) ++count;
    }
    return count > 3;
  }

  const fs::path folder = fs::path(testing::TempDir()) / "light_pieces_test";
  /// The same light, computed at once.
  const std::vector<std::byte> at_once = bytes_of(bake_light(*scene_with_shadow(), fine(), 2, nullptr, nullptr));
};

TEST_F(LightPiecesTest, that_were_finished_before_a_run_ended_are_not_computed_again) {
  const Run ended = run([&] { return has_files(); });
  ASSERT_FALSE(ended.light.has_value());
  EXPECT_EQ(ended.light.error().code(), ErrorCode::kUnavailable);
  const std::size_t kept = files().size();
  EXPECT_GT(kept, 0u);
  const Run second = run();
  EXPECT_EQ(bytes_of(second.light), at_once);
  EXPECT_EQ(second.computed, second.all - kept);
  const Run third = run();
  EXPECT_EQ(third.computed, 0u);
  EXPECT_EQ(bytes_of(third.light), at_once);
}

TEST_F(LightPiecesTest, whose_files_are_damaged_are_computed_again) {
  ASSERT_EQ(bytes_of(run().light), at_once);
  const std::vector<fs::path> all = files();
  ASSERT_GT(all.size(), 4u);
  {
    std::fstream file(all[0], std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(fs::file_size(all[0]) / 2));
    file.put('\x55').put('\xaa').put('\x55');
  }
  fs::resize_file(all[1], fs::file_size(all[1]) / 2);
  fs::resize_file(all[2], 0);
  fs::remove(all[3]);
  const Run again = run();
  EXPECT_EQ(again.computed, 4u);
  EXPECT_EQ(bytes_of(again.light), at_once);
}

TEST_F(LightPiecesTest, of_other_settings_are_removed_and_never_used) {
  ASSERT_TRUE(run().light.has_value());
  const std::vector<fs::path> before = files();
  BakeSettings other = fine();
  other.seed = 2;
  const Run second = run(nullptr, other);
  EXPECT_EQ(second.computed, second.all);
  for (const fs::path& file : before) EXPECT_FALSE(fs::exists(file)) << file;
}

TEST_F(LightPiecesTest, that_do_not_fit_on_the_disk_are_one_error_and_what_fitted_is_kept) {
  // A limit of the file size acts like a full disk at the first piece that is larger.
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit small = before;
  small.rlim_cur = 40'000;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const Run full = run();
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  ASSERT_FALSE(full.light.has_value());
  EXPECT_THAT(full.light.error().message(), HasSubstr("its disk is full; free some of it"));
  const std::size_t kept = files().size();
  const Run after = run();
  EXPECT_EQ(after.computed, after.all - kept);
  EXPECT_EQ(bytes_of(after.light), at_once);
}

/// Results that two hosts exchange: each computes every other piece, as a file's bytes, and waits for the rest.
struct Exchange {
  std::mutex mutex;
  std::condition_variable changed;
  std::map<std::pair<std::string, std::uint32_t>, PieceBytes> results;
};

class HalfOfPieces final : public LightPieces {
 public:
  HalfOfPieces(Exchange& exchange, std::uint32_t own) : exchange_(exchange), own_(own) {}
  Status begin(const std::string&) override { return Done{}; }
  Status complete(const LightStage& stage, const StageWork& work) override {
    for (const std::uint32_t piece : all_pieces(stage)) {
      if (piece % 2 == own_) {
        TRY_ASSIGN(const PieceBytes bytes, work.compute(piece));
        const std::lock_guard lock(exchange_.mutex);
        exchange_.results[{stage.key, piece}] = bytes;
        exchange_.changed.notify_all();
      }
    }
    for (const std::uint32_t piece : all_pieces(stage)) {
      std::unique_lock lock(exchange_.mutex);
      const std::pair name{stage.key, piece};
      exchange_.changed.wait(lock, [&] { return exchange_.results.contains(name); });
      const PieceBytes bytes = exchange_.results[name];
      lock.unlock();
      TRY(work.take(piece, bytes));
    }
    return Done{};
  }

 private:
  Exchange& exchange_;
  const std::uint32_t own_;
};

TEST_F(LightPiecesTest, give_every_host_the_same_light_whoever_computed_them) {
  Exchange exchange;
  std::array<std::vector<std::byte>, 2> lights;
  {
    std::vector<std::jthread> hosts;
    for (std::uint32_t host = 0; host < 2; ++host) {
      hosts.emplace_back([&, host] {
        HalfOfPieces pieces(exchange, host);
        lights[host] = bytes_of(bake_light(*scene_with_shadow(), fine(), 1, nullptr, nullptr, &pieces));
      });
    }
  }
  EXPECT_GT(exchange.results.size(), 8u);
  EXPECT_EQ(lights[0], at_once);
  EXPECT_EQ(lights[1], at_once);
}

TEST_F(LightPiecesTest, include_the_check_so_that_all_hosts_state_the_same_errors) {
  BakeSettings settings = fine();
  settings.check_eyes = 3;
  const Run first = run(nullptr, settings);
  const Run second = run(nullptr, settings);
  EXPECT_EQ(second.computed, 0u);
  EXPECT_EQ(bytes_of(second.light), bytes_of(first.light)) << "though it contains costs, which vary";
}

TEST(PieceCut, never_makes_too_many_pieces_and_leaves_nothing_out) {
  for (const std::size_t items : {0u, 1u, 63u, 64u, 65u, 100'000u, 10'000'000u}) {
    const PieceCut cut(items, 64);
    EXPECT_LE(cut.pieces(), kMaxPieces);
    std::size_t next = 0;
    for (std::uint32_t piece = 0; piece < cut.pieces(); ++piece) {
      EXPECT_EQ(cut.first(piece), next);
      EXPECT_GT(cut.end(piece), next);
      next = cut.end(piece);
    }
    EXPECT_EQ(next, items);
  }
}

TEST(PieceReader, refuses_bytes_that_are_too_short_or_too_long) {
  PieceWriter out;
  out.add(std::uint32_t{7});
  const PieceBytes bytes = out.take();
  PieceReader all(bytes);
  EXPECT_EQ(all.read<std::uint32_t>(), 7u);
  EXPECT_TRUE(all.finished());
  EXPECT_FALSE(PieceReader(bytes).finished());
  PieceReader beyond(bytes);
  EXPECT_EQ(beyond.read<double>(), 0.0);
  EXPECT_FALSE(beyond.finished());
  PieceReader count(bytes);
  EXPECT_EQ(count.read_count(1), 0u) << "there are not seven more bytes";
  EXPECT_FALSE(count.finished());
}

TEST(GridPieces, keep_every_bit_and_refuse_what_no_triangle_can_have) {
  GridInWork grid;
  grid.triangle = 5;
  grid.max_parts = 8;
  grid.visible_parts = 7.3;
  grid.is_smooth = grid.needs_surfaces = true;
  grid.parts = 2;
  grid.squared_error = 0.25f;
  grid.light.resize(6, {render::Vec3(0.1f, 0.2f, 0.3f), 0.4f});
  grid.rough = {0, 1, 0, 1, 0, 1};
  const auto written = [](const GridInWork& from) {
    PieceWriter out;
    add(from, &out);
    return out.take();
  };
  const PieceBytes bytes = written(grid);
  PieceReader in(bytes);
  const auto read = read_grid_in_work(&in, 6);
  ASSERT_TRUE(read.has_value());
  EXPECT_TRUE(in.finished());
  EXPECT_EQ(written(*read), bytes);
  PieceReader small_mesh(bytes);
  EXPECT_FALSE(read_grid_in_work(&small_mesh, 5).has_value());
  for (const auto spoil : {+[](GridInWork* g) { g->parts = 3; }, +[](GridInWork* g) { g->light.pop_back(); },
                           +[](GridInWork* g) { g->rough.push_back(0); },
                           +[](GridInWork* g) { g->max_parts = 1 << 20; }, +[](GridInWork* g) { g->parts = 16; }}) {
    GridInWork bad = grid;
    spoil(&bad);
    const PieceBytes bad_bytes = written(bad);
    PieceReader from(bad_bytes);
    EXPECT_FALSE(read_grid_in_work(&from, 6).has_value());
  }
}

}  // namespace
}  // namespace cyclorama::light_baking

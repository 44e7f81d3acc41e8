// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene_distribution/scene_cache.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <csignal>
#include <thread>

#include "tests/data_sets/scene_folder.h"

namespace cyclorama::scene_distribution {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

bool go_on(const char*, double) { return true; }

class SceneCacheTest : public testing::Test {
 protected:
  SceneCache open(std::uint64_t limit_bytes = 0) { return *SceneCache::open({folder, limit_bytes}); }
  /// Checks the scene against `wanted`, and returns the number of bytes fetched.
  std::uint64_t bring(SceneCache& cache, const SceneBytes& wanted) {
    ScriptedSource source(wanted);
    const auto held = cache.bring(files_of(wanted), source, go_on);
    EXPECT_TRUE(held) << held.error().message();
    if (!held) return 0;
    EXPECT_EQ(scene_in(held->path), wanted);
    EXPECT_EQ(held->fetched_bytes, source.given);
    return source.given;
  }
  [[nodiscard]] fs::path file(const std::string& bytes) const { return folder / "files" / sha256_of(bytes); }
  [[nodiscard]] fs::path part(const std::string& bytes) const {
    return folder / "files" / (sha256_of(bytes) + ".part");
  }

  TemporaryFolder temporary;
  const fs::path folder = temporary.path() / "cache";
  const std::string walls = noise_bytes(100, 1);
  const SceneBytes scene{{"scene.toml", "title = \"x\""}, {"a/walls.ply", walls}, {"a/same.ply", walls}, {"none", ""}};
  const std::uint64_t all = 11 + 100;
};

TEST_F(SceneCacheTest, fetches_each_file_once) {
  SceneCache cache = open();
  EXPECT_EQ(bring(cache, scene), all);
  EXPECT_EQ(bring(cache, scene), 0u);
  SceneCache again = open();
  EXPECT_EQ(bring(again, scene), 0u);
  SceneBytes other = scene;
  other["scene.toml"] = "title = \"y\"!";
  EXPECT_EQ(bring(cache, other), 12u);  // The other files are shared.
  EXPECT_EQ(fs::hard_link_count(file(walls)), 5u);
}

TEST_F(SceneCacheTest, returns_the_path_of_a_scene_that_is_one_file) {
  SceneCache cache = open();
  const SceneBytes single{{"model.glb", walls}};
  ScriptedSource source(single);
  const auto held = cache.bring(files_of(single), source, go_on);
  ASSERT_TRUE(held);
  EXPECT_EQ(held->path.filename(), "model.glb");
  EXPECT_EQ(bytes_in(held->path), walls);
}

TEST_F(SceneCacheTest, resumes_wherever_it_stopped) {
  for (std::size_t cut = 0; cut <= walls.size(); ++cut) {
    fs::remove_all(folder);
    SceneCache cache = open();
    write_bytes(part(walls), walls.substr(0, cut));
    EXPECT_EQ(bring(cache, scene), all - cut);
    EXPECT_FALSE(fs::exists(part(walls)));
  }
}

TEST_F(SceneCacheTest, resumes_wherever_the_connection_breaks) {
  for (std::size_t cut = 0; cut < all; ++cut) {
    fs::remove_all(folder);
    SceneCache cache = open();
    ScriptedSource source(scene);
    source.fail_after = cut;
    const auto failed = cache.bring(files_of(scene), source, go_on);
    ASSERT_FALSE(failed);
    EXPECT_EQ(failed.error().code(), ErrorCode::kUnavailable);
    EXPECT_THAT(failed.error().message(), HasSubstr("the line is broken"));
    EXPECT_EQ(bring(cache, scene), all - cut);
  }
}

TEST_F(SceneCacheTest, resumes_wherever_its_process_dies) {
  for (int step = 0;; ++step) {
    fs::remove_all(folder);
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      int steps = 0;
      ScriptedSource source(scene);
      auto cache = SceneCache::open({folder, 0});
      if (!cache) ::_exit(2);
      const auto held = cache->bring(files_of(scene), source, [&](const char*, double) {
        if (steps++ == step) ::_exit(1);
        return true;
      });
      ::_exit(held ? 0 : 2);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) != 2) << step;
    SceneCache cache = open();
    bring(cache, scene);
    EXPECT_EQ(bring(cache, scene), 0u);
    if (WEXITSTATUS(status) == 0) break;
  }
}

TEST_F(SceneCacheTest, fetches_damaged_files_anew_wherever_the_damage_is) {
  SceneCache first = open();
  bring(first, scene);
  for (std::size_t at = 0; at < walls.size(); ++at) {
    std::string damaged = walls;
    damaged[at] = static_cast<char>(damaged[at] ^ 1);
    write_bytes(file(walls), damaged);
    SceneCache cache = open();
    EXPECT_EQ(bring(cache, scene), 100u);
    write_bytes(file(walls), walls.substr(0, at));
    EXPECT_EQ(bring(cache, scene), 100u) << "cut at " << at;
    damaged.resize(60 + at);
    write_bytes(part(walls), damaged);  // A part with wrong content, or even too long, while the file is lost.
    fs::remove(file(walls));
    bring(cache, scene);
  }
}

TEST_F(SceneCacheTest, detects_damage_of_unchanged_size_while_it_runs) {
  SceneCache cache = open();
  bring(cache, scene);
  fs::permissions(file(walls), fs::perms::owner_all);
  const FileStamp before = open_stamped(file(walls))->stamp;
  while (open_stamped(file(walls))->stamp == before) {  // Repeats until the file system's clock has ticked.
    std::fstream(file(walls), std::ios::in | std::ios::out | std::ios::binary) << "!";  // Changes all of its links.
  }
  EXPECT_EQ(bring(cache, scene), 100u);
}

TEST_F(SceneCacheTest, repairs_a_scenes_folder) {
  SceneCache cache = open();
  bring(cache, scene);
  const fs::path linked = folder / "scenes" / digest_of(files_of(scene));
  fs::remove(linked / "none");
  EXPECT_EQ(bring(cache, scene), 0u);
  write_bytes(linked / "pareto_front.toml", "not of the scene");
  EXPECT_EQ(bring(cache, scene), 0u);
  write_bytes(linked / "scene.toml", "other");
  EXPECT_EQ(bring(cache, scene), 0u);
  fs::remove_all(linked);
  fs::create_directories(folder / "scenes/half.new/a");
  SceneCache again = open();
  EXPECT_FALSE(fs::exists(folder / "scenes/half.new"));
  EXPECT_EQ(bring(again, scene), 0u);
}

TEST_F(SceneCacheTest, refuses_a_source_with_wrong_bytes) {
  SceneCache cache = open();
  const auto refusal = [&](const std::string& lie) {
    ScriptedSource source(scene);
    source.content[sha256_of(walls)] = lie;
    const auto held = cache.bring(files_of(scene), source, go_on);
    EXPECT_FALSE(held);
    EXPECT_EQ(held ? ErrorCode::kSystem : held.error().code(), ErrorCode::kBadData);
    EXPECT_FALSE(fs::exists(file(walls)));
    EXPECT_LE(source.reads, 3);
    return held ? "" : held.error().message();
  };
  EXPECT_THAT(refusal(noise_bytes(100, 2)), HasSubstr("bytes for 'a/same.ply' that do not match its list"));
  EXPECT_THAT(refusal(walls + "!"), HasSubstr("more of 'a/same.ply'"));
  EXPECT_THAT(refusal(walls.substr(0, 99)), HasSubstr("less of 'a/same.ply'"));
  bring(cache, scene);
}

TEST_F(SceneCacheTest, drops_the_least_recently_requested_scenes) {
  SceneCache cache = open(250);
  const auto of = [](unsigned seed) { return SceneBytes{{"scene.toml", noise_bytes(100, seed)}}; };
  const auto is_there = [&](unsigned seed) { return fs::exists(folder / "scenes" / digest_of(files_of(of(seed)))); };
  const auto age = [&](unsigned seed, int hours) {
    const fs::path path = folder / "scenes" / digest_of(files_of(of(seed)));
    fs::last_write_time(path, fs::file_time_type::clock::now() - std::chrono::hours(hours));
  };
  bring(cache, of(1));
  bring(cache, of(2));
  age(1, 2);
  age(2, 1);
  bring(cache, of(3));
  EXPECT_FALSE(is_there(1));
  EXPECT_TRUE(is_there(2));
  EXPECT_FALSE(fs::exists(file(noise_bytes(100, 1))));
  ScriptedSource source(of(2));
  const auto held = cache.bring(files_of(of(2)), source, go_on);  // Requested again, and held.
  ASSERT_TRUE(held);
  age(2, 3);
  bring(cache, of(4));
  EXPECT_TRUE(is_there(2));
  EXPECT_FALSE(is_there(3));
}

TEST_F(SceneCacheTest, drops_what_belongs_to_no_scene_first) {
  SceneCache cache = open(250);
  write_bytes(part("left over"), noise_bytes(120, 9));
  write_bytes(folder / "files/not ours", noise_bytes(1000, 9));
  bring(cache, scene);
  EXPECT_TRUE(fs::exists(part("left over")));
  bring(cache, {{"scene.toml", noise_bytes(130, 3)}});
  EXPECT_FALSE(fs::exists(part("left over")));
  EXPECT_TRUE(fs::exists(folder / "files/not ours"));
  EXPECT_TRUE(fs::exists(file(walls)));
}

TEST_F(SceneCacheTest, reports_a_scene_over_the_limit) {
  SceneCache cache = open(all - 1);
  ScriptedSource source(scene);
  const auto held = cache.bring(files_of(scene), source, go_on);
  ASSERT_FALSE(held);
  EXPECT_THAT(held.error().message(), HasSubstr("raise cache_gib"));
  EXPECT_EQ(source.given, 0u);
  SceneCache enough = open(all);
  EXPECT_EQ(bring(enough, scene), all);
}

TEST_F(SceneCacheTest, reports_a_full_disk) {
  SceneCache cache = open();
  const SceneBytes large{{"scene.toml", noise_bytes(100'000, 1)}};
  ScriptedSource source(large);
  source.piece = 4096;
  ::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const rlimit tight{50'000, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &tight);
  const auto held = cache.bring(files_of(large), source, go_on);
  ::setrlimit(RLIMIT_FSIZE, &before);
  ASSERT_FALSE(held);
  EXPECT_THAT(held.error().message(), HasSubstr("writing 'scene.toml' to the cache"));
  EXPECT_THAT(held.error().message(), HasSubstr("full; free some of it"));
  EXPECT_EQ(bring(cache, large), 50'000u);  // Bytes fetched earlier are kept.
}

TEST_F(SceneCacheTest, gives_up_at_any_step_on_request) {
  for (int step = 0;; ++step) {
    fs::remove_all(folder);
    SceneCache cache = open();
    ScriptedSource source(scene);
    int steps = 0;
    const auto held = cache.bring(files_of(scene), source, [&](const char*, double) { return steps++ != step; });
    if (held) break;
    EXPECT_EQ(held.error().code(), ErrorCode::kUnavailable);
    bring(cache, scene);
  }
}

TEST_F(SceneCacheTest, is_shared_by_several_nodes_of_one_host) {
  std::atomic<std::uint64_t> fetched = 0;
  const SceneBytes other{{"scene.toml", noise_bytes(5'000, 7)}, {"walls.ply", walls}};
  {
    std::vector<std::jthread> nodes;
    for (int node = 0; node < 4; ++node) {
      nodes.emplace_back([&, node] {
        SceneCache cache = open();
        for (int round = 0; round < 5; ++round) fetched += bring(cache, (node + round) % 2 == 0 ? scene : other);
      });
    }
  }
  EXPECT_EQ(fetched, all + 5'000u);
}

TEST_F(SceneCacheTest, reports_where_it_cannot_write) {
  write_bytes(folder, "a file in the way");
  const auto opened = SceneCache::open({folder, 0});
  ASSERT_FALSE(opened);
  EXPECT_THAT(opened.error().message(), HasSubstr("give 'cache' a place"));
}

}  // namespace
}  // namespace cyclorama::scene_distribution

// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/scene_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>

#include "tests/doubles/fake_block_renderer.h"

namespace cyclorama::node {
namespace {

using testing::HasSubstr;

wire::LoadScene order(const std::string& scene, const std::string& path) {
  wire::LoadScene load;
  load.set_scene(scene);
  load.set_path(path);
  return load;
}

wire::SceneLoaded load(SceneStore& store, const std::string& scene, const std::string& path, LinkId link = 1,
                       std::vector<SceneStore::Name>* ret_left = nullptr, const std::vector<std::string>& in_use = {}) {
  std::vector<SceneStore::Name> left;
  wire::LoadScene asked = order(scene, path);
  for (const std::string& name : in_use) asked.add_in_use(name);
  return store.load(
      link, asked, path, [](double) {}, ret_left == nullptr ? &left : ret_left);
}

/// Makes scenes of the given sizes in bytes, by path.
SceneLoader sized_loader(std::map<std::string, std::uint64_t> bytes, int* loads) {
  return [bytes, loads](const std::string& path,
                        const std::function<void(double)>&) -> Result<std::unique_ptr<BlockRenderer>> {
    ++*loads;
    return std::unique_ptr<BlockRenderer>(
        std::make_unique<FakeBlockRenderer>(std::make_shared<FakeRendering>(), bytes.at(path)));
  };
}

TEST(SceneStore, loads_a_scene_once_and_keeps_it) {
  int loads = 0;
  SceneStore store([&](const std::string& path, const std::function<void(double)>& progress) {
    ++loads;
    return fake_loader()(path, progress);
  });
  double seen = 0.0;
  const auto progress = [&](double fraction) { seen = fraction; };
  std::vector<SceneStore::Name> left;
  EXPECT_EQ(store.find(1, "grotto"), nullptr);
  const auto first = store.load(1, order("grotto", "a"), "a", progress, &left);
  EXPECT_EQ(first.error(), "");
  EXPECT_EQ(first.description().name(), "grotto");
  EXPECT_EQ(first.memory_bytes(), 1000u);
  EXPECT_EQ(seen, 0.5);
  EXPECT_EQ(first.probe_cpu_seconds(), 0.25);
  EXPECT_NE(store.find(1, "grotto"), nullptr);
  EXPECT_EQ(load(store, "grotto", "a").SerializeAsString(), first.SerializeAsString());
  EXPECT_EQ(loads, 1);
  load(store, "grotto", "b");
  EXPECT_EQ(loads, 2);
  load(store, "grotto", "a");
  EXPECT_EQ(loads, 3) << "one name stands for one scene";
}

TEST(SceneStore, shares_scenes_between_coordinators_under_any_names) {
  int loads = 0;
  SceneStore store(sized_loader({{"a", 1}, {"b", 1}}, &loads));
  load(store, "grotto", "a", 1);
  const auto other = load(store, "cave", "a", 2);
  EXPECT_EQ(loads, 1);
  EXPECT_EQ(other.scene(), "cave");
  EXPECT_EQ(other.description().name(), "cave");
  EXPECT_EQ(store.find(1, "grotto"), store.find(2, "cave"));
  EXPECT_EQ(store.find(2, "grotto"), nullptr);
  load(store, "grotto", "b", 1);
  EXPECT_NE(store.find(2, "cave"), nullptr) << "the other coordinator goes on with it";
  store.forget_link(2);
  EXPECT_EQ(store.find(2, "cave"), nullptr);
  load(store, "cave", "a", 3);
  EXPECT_EQ(loads, 2) << "it stayed in memory";
}

TEST(SceneStore, drops_the_least_recently_used_scene_when_memory_is_short) {
  int loads = 0;
  SceneStore store(sized_loader({{"a", 40}, {"b", 40}, {"c", 50}, {"d", 30}}, &loads), 100);
  std::vector<SceneStore::Name> left;
  load(store, "A", "a", 1, &left);
  load(store, "B", "b", 1, &left);
  load(store, "A2", "a", 2, &left);
  EXPECT_TRUE(left.empty());
  EXPECT_EQ(load(store, "C", "c", 1, &left).error(), "");
  ASSERT_EQ(left.size(), 1u);
  EXPECT_EQ(left[0], (SceneStore::Name{1, "B"}));
  EXPECT_EQ(store.find(1, "B"), nullptr);
  left.clear();
  EXPECT_EQ(load(store, "D", "d", 1, &left).error(), "");
  EXPECT_THAT(left, testing::UnorderedElementsAre(SceneStore::Name{1, "A"}, SceneStore::Name{2, "A2"}));
}

TEST(SceneStore, never_drops_a_scene_in_use_and_reports_it) {
  int loads = 0;
  SceneStore store(sized_loader({{"a", 40}, {"b", 40}, {"c", 50}, {"d", 200}}, &loads), 100);
  std::vector<SceneStore::Name> left;
  load(store, "A", "a");
  load(store, "B", "b");
  EXPECT_EQ(load(store, "C", "c", 1, &left, {"A"}).error(), "") << "B leaves, though A was used longer ago";
  ASSERT_EQ(left.size(), 1u);
  EXPECT_EQ(left[0].scene, "B");
  left.clear();
  EXPECT_THAT(load(store, "B", "b", 1, &left, {"A", "C"}).error(), HasSubstr("memory_gib"));
  EXPECT_TRUE(left.empty());
  EXPECT_NE(store.find(1, "A"), nullptr);
  {
    const auto held = store.find(1, "C");
    EXPECT_THAT(load(store, "B", "b", 1, &left, {"A"}).error(), HasSubstr("GiB")) << "blocks wait for C";
  }
  EXPECT_EQ(load(store, "B", "b", 1, &left, {"A"}).error(), "");
  left.clear();
  EXPECT_THAT(load(store, "D", "d", 1, &left).error(), HasSubstr("'d' takes")) << "larger than all memory";
  EXPECT_TRUE(left.empty()) << "nobody leaves for nothing";
  load(store, "A", "a", 1, &left, {"A"});
  EXPECT_THAT(load(store, "C", "d", 2, &left).error(), HasSubstr("'d' takes"));
  EXPECT_NE(store.find(1, "A"), nullptr) << "another coordinator's session holds it";
}

TEST(SceneStore, reports_why_a_scene_cannot_be_loaded) {
  SceneStore store(fake_loader());
  EXPECT_THAT(load(store, "x", "missing").error(), HasSubstr("no such file"));
  EXPECT_THAT(load(store, "x", "huge").error(), HasSubstr("more memory than this host has"));
  EXPECT_EQ(store.find(1, "x"), nullptr);
}

TEST(SceneStore, reports_the_pareto_front_in_the_scenes_folder_and_refuses_a_wrong_one) {
  const std::filesystem::path folder = testing::TempDir() + "scene_store_front";
  std::filesystem::create_directories(folder);
  SceneStore store(fake_loader());
  const std::string front = "[[point]]\ncpu_us_per_px = 1\nerror = 2\n";
  std::ofstream(folder / "pareto_front.toml") << front;
  EXPECT_EQ(load(store, "x", folder).front(), front);
  EXPECT_EQ(load(store, "y", "a").front(), "");
  std::ofstream(folder / "pareto_front.toml") << "[[point]]\ncpu_us_per_px = 0\n";
  SceneStore another(fake_loader());
  const auto refused = load(another, "z", folder);
  EXPECT_THAT(refused.error(), HasSubstr("pareto_front.toml:1: point[0].error: is missing"));
  std::filesystem::rename(folder / "pareto_front.toml", folder / "front.toml");
  EXPECT_THAT(load(another, "z", folder).error(), HasSubstr("front.toml' is called pareto_front.toml now; rename it"));
  std::filesystem::remove_all(folder);
}

TEST(SceneStore, survives_a_loader_that_throws) {
  SceneStore store(
      [](const std::string&, const std::function<void(double)>&) -> Result<std::unique_ptr<BlockRenderer>> {
        throw std::runtime_error("a library had enough");
      });
  EXPECT_THAT(load(store, "x", "y").error(), HasSubstr("a library had enough"));
}

}  // namespace
}  // namespace cyclorama::node

// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/scene_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/doubles/fake_block_renderer.h"

namespace cyclorama {
namespace {

using testing::HasSubstr;

wire::LoadScene order(const std::string& scene, const std::string& path) {
  wire::LoadScene load;
  load.set_scene(scene);
  load.set_path(path);
  return load;
}

TEST(SceneStore, loads_a_scene_once_and_keeps_it) {
  int loads = 0;
  SceneStore store([&](const std::string& path, const std::function<void(double)>& progress) {
    ++loads;
    return fake_loader()(path, progress);
  });
  double seen = 0.0;
  const auto progress = [&](double fraction) { seen = fraction; };
  EXPECT_EQ(store.find("grotto"), nullptr);
  const auto first = store.load(order("grotto", "a"), progress);
  EXPECT_EQ(first.error(), "");
  EXPECT_EQ(first.description().name(), "grotto");
  EXPECT_EQ(first.memory_bytes(), 1000u);
  EXPECT_EQ(seen, 0.5);
  EXPECT_NE(store.find("grotto"), nullptr);
  EXPECT_EQ(store.load(order("grotto", "a"), progress).SerializeAsString(), first.SerializeAsString());
  EXPECT_EQ(loads, 1);
  store.load(order("grotto", "b"), progress);
  EXPECT_EQ(loads, 2);
}

TEST(SceneStore, answers_with_the_reason_when_a_scene_cannot_be_loaded) {
  SceneStore store(fake_loader());
  EXPECT_THAT(store.load(order("x", "missing"), [](double) {}).error(), HasSubstr("no such file"));
  EXPECT_THAT(store.load(order("x", "huge"), [](double) {}).error(), HasSubstr("more memory than this host has"));
  EXPECT_EQ(store.find("x"), nullptr);
}

TEST(SceneStore, tells_the_front_in_the_scenes_folder_and_refuses_a_wrong_one) {
  const std::filesystem::path folder = testing::TempDir() + "scene_store_front";
  std::filesystem::create_directories(folder);
  SceneStore store(fake_loader());
  const std::string front = "[[point]]\ncpu_us_per_px = 1\nerror = 2\n";
  std::ofstream(folder / "front.toml") << front;
  EXPECT_EQ(store.load(order("x", folder), [](double) {}).front(), front);
  EXPECT_EQ(store.load(order("y", "a"), [](double) {}).front(), "");
  std::ofstream(folder / "front.toml") << "[[point]]\ncpu_us_per_px = 0\n";
  const auto refused = store.load(order("z", folder), [](double) {});
  EXPECT_THAT(refused.error(), HasSubstr("front.toml:1: point[0].error: is missing"));
  std::filesystem::remove_all(folder);
}

TEST(SceneStore, survives_a_loader_that_throws) {
  SceneStore store(
      [](const std::string&, const std::function<void(double)>&) -> Result<std::unique_ptr<BlockRenderer>> {
        throw std::runtime_error("a library had enough");
      });
  EXPECT_THAT(store.load(order("x", "y"), [](double) {}).error(), HasSubstr("a library had enough"));
}

}  // namespace
}  // namespace cyclorama

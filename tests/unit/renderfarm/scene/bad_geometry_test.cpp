// SPDX-License-Identifier: Apache-2.0
// Every PLY and OBJ file of the shared invalid data loads, or gives one clear error.
#include <gtest/gtest.h>

#include <cstdio>
#include <set>

#include "renderfarm/scene/scene.h"
#include "tests/data_sets/shared_data.h"
#include "tests/support/model_invariants.h"

namespace cyclorama::scene {
namespace {

constexpr ImportLimits kLimits{.memory_bytes = std::size_t{1} << 30};

TEST(BadGeometry, every_file_loads_or_gives_one_clear_error) {
  CYCLORAMA_SHARED_DATA(folder, "bad");
  int loaded = 0;
  int refused = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".ply" && entry.path().extension() != ".obj") continue;
    const auto scene = load_scene(entry.path(), kLimits, nullptr);
    if (scene) {
      ++loaded;
      EXPECT_GT(scene->triangles_stored(), 0u);
      EXPECT_EQ(broken_promise(scene->model), "") << entry.path();
      continue;
    }
    ++refused;
    const std::string& message = scene.error().message();
    EXPECT_EQ(scene.error().code(), ErrorCode::kBadData) << message;
    EXPECT_NE(message.find(entry.path().filename().string()), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    std::printf("  %s\n", message.substr(folder.string().size() + 1).c_str());
  }
  std::printf("%d loaded, %d refused\n", loaded, refused);
  EXPECT_GT(loaded, 0);
}

TEST(BadGeometry, odd_but_valid_files_load_unless_they_have_no_surface) {
  CYCLORAMA_SHARED_DATA(folder, "bad/assimp/odd_but_valid");
  // It announces a list in each vertex that its rows do not have.
  const std::set<std::string> without_surface = {"issue623.ply"};
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const auto scene = load_scene(entry.path(), kLimits, nullptr);
    EXPECT_EQ(scene.has_value(), !without_surface.contains(name)) << name;
  }
}

TEST(BadGeometry, invalid_files_are_refused) {
  CYCLORAMA_SHARED_DATA(folder, "bad/assimp/invalid");
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    EXPECT_FALSE(load_scene(entry.path(), kLimits, nullptr).has_value()) << entry.path();
  }
}

}  // namespace
}  // namespace cyclorama::scene

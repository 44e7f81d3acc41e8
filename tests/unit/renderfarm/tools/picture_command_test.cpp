// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/tools/picture_command.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/base/file.h"

namespace cyclorama::tools {
namespace {

class PictureCommand : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) / ("picture_command_test_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
    // A tent, seen from inside.
    ASSERT_TRUE(write_file_atomically(
        folder_ / "tent.obj", std::string_view("v -2 0 -2\nv 2 0 -2\nv 0 0 3\nv 0 3 0\nf 1 2 3\nf 1 2 4\nf 2 3 4\n")));
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// Returns the number of rays for a picture of the tent.
  std::uint64_t rays(const std::string& settings, std::vector<std::string> options) {
    EXPECT_TRUE(write_file_atomically(
        folder_ / "scene.toml",
        std::string_view(
            "title = 'x'\n" + settings +
            "[light]\nambient = [1, 1, 1]\n[start]\neye_m = [0, 1, 0]\n[[geometry]]\nfile = 'tent.obj'\n")));
    CLI::App program;
    const RenderCommand command = add_picture_command(&program);
    for (const std::string& more :
         {std::string("16x8"), std::string("--size"), (folder_ / "cost.json").string(), std::string("--json"),
          (folder_ / "x.png").string(), std::string("--out"), folder_.string(), std::string("picture")}) {
      options.push_back(more);  // CLI11 takes arguments from the back.
    }
    program.parse(options);
    const Status status = command.run(StopSignal());
    EXPECT_TRUE(status.has_value()) << (status ? "" : status.error().message());
    const auto text = read_text_file(folder_ / "cost.json", 1 << 20);
    return text ? nlohmann::json::parse(*text).at("rays").get<std::uint64_t>() : 0;
  }
  std::filesystem::path folder_;
};

TEST_F(PictureCommand, has_the_bounces_of_the_scene_by_default) {
  const std::uint64_t direct = rays("bounces = 0\n", {});
  const std::uint64_t scattered_twice = rays("bounces = 2\n", {});
  EXPECT_GT(direct, 0u);
  EXPECT_GT(scattered_twice, direct);
  EXPECT_EQ(rays("bounces = 2\n", {"0", "--bounces"}), direct);
  EXPECT_EQ(rays("", {}), rays("", {"4", "--bounces"}));
}

}  // namespace
}  // namespace cyclorama::tools

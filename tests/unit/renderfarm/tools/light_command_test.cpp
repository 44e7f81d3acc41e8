// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/tools/light_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "common/base/file.h"
#include "renderfarm/light/light_file.h"

namespace cyclorama::tools {
namespace {

using testing::HasSubstr;

namespace fs = std::filesystem;

class LightCommand : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder);
    write_tent("0 3 0");
    ASSERT_TRUE(
        write_file_atomically(folder / "scene.toml",
                              std::string_view("title = 'x'\n[light]\nambient = [1, 1, 1]\n[start]\neye_m = [0, 1, 0]\n"
                                               "[[geometry]]\nfile = 'tent.obj'\n")));
  }
  void TearDown() override { fs::remove_all(folder); }

  void write_tent(const std::string& top) const {
    ASSERT_TRUE(write_file_atomically(folder / "tent.obj",
                                      "v -2 0 -2\nv 2 0 -2\nv 0 0 3\nv " + top + "\nf 1 2 3\nf 1 2 4\nf 2 3 4\n"));
  }
  /// Runs the command and returns what it prints.
  [[nodiscard]] std::string run() const {
    CLI::App program;
    const RenderCommand command = add_light_command(&program);
    program.parse(
        std::vector<std::string>{"0", "--check-eyes", "2", "--eyes", "--if-needed", folder.string(), "light"});
    testing::internal::CaptureStdout();
    const Status status = command.run(StopSignal());
    EXPECT_TRUE(status.has_value()) << (status ? "" : status.error().message());
    return testing::internal::GetCapturedStdout();
  }
  [[nodiscard]] bool is_sound() const { return light::read_light_file(file).has_value(); }

  const fs::path folder = fs::path(testing::TempDir()) / ("light_command_test_" + std::to_string(::getpid()));
  const fs::path file = folder / "light.store";
};

TEST_F(LightCommand, computes_light_only_if_it_is_needed) {
  EXPECT_THAT(run(), HasSubstr("bytes per triangle"));
  ASSERT_TRUE(is_sound());
  const auto written = fs::last_write_time(file);
  EXPECT_THAT(run(), HasSubstr("it has the light of this scene"));
  EXPECT_EQ(fs::last_write_time(file), written);
}

TEST_F(LightCommand, makes_a_damaged_file_and_that_of_another_scene_anew_and_names_it) {
  ASSERT_FALSE(run().empty());
  fs::resize_file(file, fs::file_size(file) - 1);
  EXPECT_THAT(run(), testing::AllOf(HasSubstr(file.string()), HasSubstr("damaged"), HasSubstr("doing so now")));
  EXPECT_TRUE(is_sound());
  write_tent("0 2 0");
  EXPECT_THAT(run(), testing::AllOf(HasSubstr(file.string()), HasSubstr("another scene"), HasSubstr("doing so now")));
  EXPECT_THAT(run(), HasSubstr("it has the light of this scene"));
}

TEST_F(LightCommand, leaves_no_pieces_behind) {
  ASSERT_FALSE(run().empty());
  for (const auto& entry : fs::directory_iterator(folder)) {
    EXPECT_FALSE(entry.path().filename().string().starts_with('.')) << entry.path();
  }
}

}  // namespace
}  // namespace cyclorama::tools

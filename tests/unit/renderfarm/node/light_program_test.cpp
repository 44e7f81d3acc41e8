// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/light_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <fstream>

#include "renderfarm/node/embree_block_renderer.h"

namespace cyclorama::node {
namespace {

using testing::HasSubstr;

namespace fs = std::filesystem;

class LightProgram : public testing::Test {
 protected:
  LightProgram() {
    fs::remove_all(folder);
    fs::create_directories(folder / "out");
    std::ofstream(scene) << "v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nv -2 1 -2\nv 2 1 -2\nf 1 3 2\nf 1 4 3\nf 1 2 6\n"
                            "f 1 6 5\n";
  }
  ~LightProgram() override { fs::remove_all(folder); }

  const fs::path folder = fs::path(testing::TempDir()) / "light_program_test";
  const fs::path scene = folder / "sheet.obj";
  const fs::path file = folder / "out" / "light.store";
};

TEST_F(LightProgram, writes_light_that_the_scenes_renderer_uses) {
  double last = 0.0;
  const Status done = compute_light(scene, file, 2, [&](double share) {
    EXPECT_GE(share, last);
    last = share;
  });
  ASSERT_TRUE(done) << done.error().message();
  EXPECT_EQ(last, 1.0);
  const auto renderer = *embree_scene_loader(2)(scene.string(), [](double) {});
  EXPECT_TRUE(renderer->wants_light());
  EXPECT_EQ(renderer->pareto_front(), "");
  const auto use = renderer->light_from(file);
  ASSERT_TRUE(use) << use.error().message();
  EXPECT_TRUE(renderer->wants_light()) << "not before it is called";
  (*use)();
  EXPECT_FALSE(renderer->wants_light());
  EXPECT_THAT(renderer->pareto_front(), HasSubstr("stored_light = true"));
}

TEST_F(LightProgram, refuses_light_of_another_scene_and_a_damaged_file) {
  ASSERT_TRUE(compute_light(scene, file, 2, [](double) {}));
  std::ofstream(folder / "other.obj") << "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 3 2\n";
  const auto other = *embree_scene_loader(1)((folder / "other.obj").string(), [](double) {});
  EXPECT_THAT(other->light_from(file).error().message(), HasSubstr("another scene"));
  fs::resize_file(file, fs::file_size(file) - 1);
  const auto renderer = *embree_scene_loader(1)(scene.string(), [](double) {});
  EXPECT_THAT(renderer->light_from(file).error().message(), HasSubstr("damaged"));
}

TEST_F(LightProgram, tells_of_a_full_disk_and_leaves_nothing) {
  // A limit on the size of files fails like a full disk.
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{16, before.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const Status done = compute_light(scene, file, 2, [](double) {});
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  ASSERT_FALSE(done);
  EXPECT_THAT(done.error().message(), HasSubstr("disk is full"));
  EXPECT_TRUE(fs::is_empty(file.parent_path()));
}

}  // namespace
}  // namespace cyclorama::node

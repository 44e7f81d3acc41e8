// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/light_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <fstream>

#include "common/base/file.h"
#include "renderfarm/light/light_file.h"
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

  [[nodiscard]] Result<VersionedLight> added(BlockRenderer& renderer) const {
    TRY_ASSIGN(const MappedFile mapped, MappedFile::open(file));
    return renderer.add_light(mapped.bytes(), file.string());
  }

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
  const auto renderer = *embree_scene_loader(std::make_shared<render::Crew>(2))(scene.string(), [](double) {});
  EXPECT_TRUE(renderer->can_have_light());
  EXPECT_FALSE(renderer->light_versions()->newest());
  const auto light = added(*renderer);
  ASSERT_TRUE(light) << light.error().message();
  EXPECT_EQ(renderer->light_versions()->newest()->version, light->version);
  EXPECT_EQ(light->file_bytes, fs::file_size(file));
  EXPECT_THAT(light->store->settings, HasSubstr("cyclorama " CYCLORAMA_VERSION));
  EXPECT_EQ(version_of(light::light_file_bytes(*light->store)), light->version)
      << "a node can send the light that it has in memory";
}

TEST_F(LightProgram, refuses_light_of_another_scene_and_a_damaged_file) {
  ASSERT_TRUE(compute_light(scene, file, 2, [](double) {}));
  std::ofstream(folder / "other.obj") << "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 3 2\n";
  const auto other =
      *embree_scene_loader(std::make_shared<render::Crew>(1))((folder / "other.obj").string(), [](double) {});
  EXPECT_THAT(added(*other).error().message(), HasSubstr("another scene"));
  fs::resize_file(file, fs::file_size(file) - 1);
  const auto renderer = *embree_scene_loader(std::make_shared<render::Crew>(1))(scene.string(), [](double) {});
  EXPECT_THAT(added(*renderer).error().message(), HasSubstr("damaged"));
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

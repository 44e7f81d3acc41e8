// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/generator/package.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <csignal>

#include "common/base/file.h"
#include "renderfarm/generator/chamber.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::generator {
namespace {

namespace fs = std::filesystem;

bool always(double) { return true; }

class GrottoPackage : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = testing::TempDir() + "grotto.XXXXXX";
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    parent_ = name;
    order_ = {.triangles = 10'000, .seed = 4, .folder = parent_ / "one", .replace = false, .threads = 2};
  }
  void TearDown() override { fs::remove_all(parent_); }

  /// Returns the names of everything beside and inside the target.
  [[nodiscard]] std::vector<std::string> everything() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(parent_))
      names.push_back(fs::relative(entry.path(), parent_));
    std::sort(names.begin(), names.end());
    return names;
  }

  [[nodiscard]] std::string bytes(const std::string& name) const {
    const auto text = read_text_file(order_.folder / name, std::size_t{64} << 20);
    return text ? *text : "";
  }

  fs::path parent_;
  PackageOrder order_;
};

TEST_F(GrottoPackage, is_a_scene_that_loads) {
  const auto report = write_package(order_, always);
  ASSERT_TRUE(report.has_value()) << report.error().message();
  const auto scene = scene::load_scene(order_.folder, scene::ImportLimits{}, nullptr);
  ASSERT_TRUE(scene.has_value()) << scene.error().message();
  EXPECT_EQ(scene->triangles_stored(), report->counts.triangles);
  EXPECT_THAT(scene->model.notes, testing::IsEmpty());
  EXPECT_EQ(scene->info.start_eye, Eigen::Vector3d(0.0, 1.6, 3.1));
  EXPECT_GE(scene->info.walkable.size(), 4u);
  EXPECT_GE(scene->info.stops.size(), 4u);
  EXPECT_GE(scene->model.lights.size(), 5u);
  EXPECT_TRUE(scene->bounds.contains(Eigen::Vector3d(0.0, 1.6, 3.1)));
}

TEST_F(GrottoPackage, has_its_start_and_stops_in_the_walkable_area) {
  ASSERT_TRUE(write_package(order_, always).has_value());
  const auto scene = scene::load_scene(order_.folder, scene::ImportLimits{}, nullptr);
  ASSERT_TRUE(scene.has_value());
  const auto inside = [&](const Eigen::Vector3d& eye) {
    bool in = false;
    const auto& area = scene->info.walkable;
    for (std::size_t i = 0, j = area.size() - 1; i < area.size(); j = i++) {
      const bool crosses = (area[i].y() > eye.z()) != (area[j].y() > eye.z());
      if (crosses &&
          eye.x() < area[i].x() + (area[j].x() - area[i].x()) * (eye.z() - area[i].y()) / (area[j].y() - area[i].y()))
        in = !in;
    }
    return in;
  };
  EXPECT_TRUE(inside(scene->info.start_eye - Eigen::Vector3d(0.0, 0.0, 0.01)));
  for (const scene::SceneTourStop& stop : scene->info.stops)
    EXPECT_TRUE(inside(stop.eye - Eigen::Vector3d(0.0, 0.0, 0.01))) << stop.title;
  for (const Eigen::Vector2d& corner : scene->info.walkable) {
    EXPECT_GT(corner.y(), static_cast<double>(kAltarFront));
    EXPECT_LT(std::abs(corner.x()), static_cast<double>(kHalfLength));
  }
}

TEST_F(GrottoPackage, is_identical_for_the_same_request) {
  const auto report = write_package(order_, always);
  ASSERT_TRUE(report.has_value());
  std::map<std::string, std::string> first;
  std::uint64_t written = 0;
  for (const auto& entry : fs::directory_iterator(order_.folder)) {
    first[entry.path().filename()] = bytes(entry.path().filename());
    if (entry.path().extension() == ".ply") written += entry.file_size();
  }
  EXPECT_EQ(written, report->bytes);
  order_.folder = parent_ / "two";
  order_.threads = 5;
  ASSERT_TRUE(write_package(order_, always).has_value());
  for (const auto& [name, content] : first) EXPECT_EQ(bytes(name), content) << name;
}

TEST_F(GrottoPackage, replaces_a_folder_only_if_it_is_a_grotto_and_replacing_was_requested) {
  ASSERT_TRUE(write_package(order_, always).has_value());
  const std::string old = bytes("scene.toml");
  const auto names = everything();
  order_.triangles = 20'000;
  const auto refused = write_package(order_, always);
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code(), ErrorCode::kBusy);
  EXPECT_THAT(refused.error().message(), testing::HasSubstr("--force"));
  EXPECT_EQ(bytes("scene.toml"), old);
  order_.replace = true;
  order_.folder += "/";  // With the slash that a shell's completion adds.
  ASSERT_TRUE(write_package(order_, always).has_value());
  EXPECT_NE(bytes("scene.toml"), old);
  EXPECT_EQ(everything(), names);
}

TEST_F(GrottoPackage, never_replaces_anything_else) {
  order_.replace = true;
  ASSERT_TRUE(write_file_atomically(order_.folder, "a file").has_value());
  EXPECT_FALSE(write_package(order_, always).has_value());
  fs::remove(order_.folder);
  fs::create_directory(order_.folder);
  ASSERT_TRUE(write_file_atomically(order_.folder / "scene.toml", "title = \"a relic\"\n").has_value());
  const auto refused = write_package(order_, always);
  ASSERT_FALSE(refused.has_value());
  EXPECT_THAT(refused.error().message(), testing::HasSubstr("not a grotto"));
  EXPECT_THAT(everything(), testing::ElementsAre("one", "one/scene.toml"));
}

TEST_F(GrottoPackage, accepts_an_empty_folder) {
  fs::create_directory(order_.folder);
  ASSERT_TRUE(write_package(order_, always).has_value());
  EXPECT_TRUE(fs::exists(order_.folder / "scene.toml"));
}

TEST_F(GrottoPackage, leaves_nothing_when_cancelled) {
  order_.triangles = 20'000'000;
  const auto stopped = write_package(order_, [](double) { return false; });
  ASSERT_FALSE(stopped.has_value());
  EXPECT_EQ(stopped.error().code(), ErrorCode::kUnavailable);
  EXPECT_THAT(everything(), testing::IsEmpty());
}

TEST_F(GrottoPackage, leaves_nothing_when_a_file_cannot_be_written) {
  // The maximum file size of this process simulates a full disk: the kernel refuses at the same point.
  rlimit old{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old), 0);
  ASSERT_NE(std::signal(SIGXFSZ, SIG_IGN), SIG_ERR);
  const rlimit small{100'000, old.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  order_.triangles = 200'000;
  const auto failed = write_package(order_, always);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &old), 0);
  ASSERT_FALSE(failed.has_value());
  EXPECT_EQ(failed.error().code(), ErrorCode::kSystem);
  EXPECT_THAT(failed.error().message(), testing::HasSubstr(".ply"));
  EXPECT_THAT(everything(), testing::IsEmpty());
}

TEST_F(GrottoPackage, reports_a_missing_parent_folder) {
  order_.folder = parent_ / "absent" / "one";
  const auto failed = write_package(order_, always);
  ASSERT_FALSE(failed.has_value());
  EXPECT_EQ(failed.error().code(), ErrorCode::kNotFound);
}

}  // namespace
}  // namespace cyclorama::generator

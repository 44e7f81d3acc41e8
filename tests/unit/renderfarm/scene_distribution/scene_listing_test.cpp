// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene_distribution/scene_listing.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/data_sets/scene_folder.h"

namespace cyclorama::scene_distribution {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class SceneListingTest : public testing::Test {
 protected:
  Result<SceneListing> list(const fs::path& path, DigestMemory* memory = nullptr) {
    DigestMemory none{fs::path()};
    return list_scene(path, memory != nullptr ? *memory : none, [](double) { return true; });
  }
  std::string refusal(const fs::path& path) {
    const auto listed = list(path);
    return listed ? "" : listed.error().message();
  }
  TemporaryFolder temporary;
  const fs::path folder = temporary.path() / "scene";
  const SceneBytes scene{{"scene.toml", "title = \"x\""},
                         {"walls.ply", noise_bytes(3'000'000, 1)},
                         {"textures/a.png", "a"},
                         {"textures/b.png", "a"},
                         {"empty", ""}};
  void SetUp() override {
    for (const auto& [path, bytes] : scene) write_bytes(folder / path, bytes);
  }
};

TEST_F(SceneListingTest, lists_all_files_of_a_folder_except_hidden_ones) {
  write_bytes(folder / ".git/config", "x");
  write_bytes(folder / "textures/.DS_Store", "x");
  const auto listed = list(folder);
  ASSERT_TRUE(listed) << listed.error().message();
  EXPECT_EQ(listed->files, files_of(scene));
  ASSERT_EQ(listed->places.size(), scene.size());
  for (std::size_t i = 0; i < scene.size(); ++i) {
    EXPECT_EQ(listed->places[i].path, folder / listed->files[i].path);
    EXPECT_EQ(listed->places[i].stamp, open_stamped(listed->places[i].path)->stamp);
  }
}

TEST_F(SceneListingTest, accepts_a_single_file_only_if_it_is_a_scene) {
  const auto listed = list(folder / "walls.ply");
  ASSERT_TRUE(listed);
  EXPECT_EQ(listed->files, (SceneFiles{{"walls.ply", 3'000'000, sha256_of(scene.at("walls.ply"))}}));
  write_bytes(folder / "model.gltf", "{}");
  EXPECT_THAT(refusal(folder / "model.gltf"), HasSubstr("put it in a folder"));
  EXPECT_THAT(refusal(folder / "missing.ply"), HasSubstr("No such file"));
}

TEST_F(SceneListingTest, refuses_folders_without_a_scene) {
  EXPECT_THAT(refusal(folder / "textures"), HasSubstr("no scene.toml"));
  EXPECT_THAT(refusal(temporary.path() / "missing"), HasSubstr("No such file"));
  fs::create_symlink("walls.ply", folder / "link.ply");
  EXPECT_THAT(refusal(folder), HasSubstr("link.ply' is a link"));
  fs::remove(folder / "link.ply");
  ::mkfifo((folder / "pipe").c_str(), 0600);
  EXPECT_THAT(refusal(folder), HasSubstr("no regular file"));
  fs::remove(folder / "pipe");
  write_bytes(folder / "Gr\xfcn", "x");
  EXPECT_THAT(refusal(folder), HasSubstr("UTF-8"));
  fs::remove(folder / "Gr\xfcn");
  EXPECT_EQ(refusal(folder), "");
}

TEST_F(SceneListingTest, reports_progress_and_gives_up_on_request) {
  DigestMemory memory{fs::path()};
  double last = 0.0;
  ASSERT_TRUE(list_scene(folder, memory, [&](double done) {
    EXPECT_GE(done, last);
    last = done;
    return true;
  }));
  EXPECT_EQ(last, 1.0);
  const auto given_up = list_scene(folder, memory, [](double) { return false; });
  ASSERT_FALSE(given_up);
  EXPECT_EQ(given_up.error().code(), ErrorCode::kUnavailable);
}

TEST_F(SceneListingTest, reads_only_changed_files_again) {
  const HashedFile old{{.inode = 1, .bytes = 2, .modified_ns = 3, .changed_ns = 4}, std::string(64, 'a')};
  const fs::path file = temporary.path() / "digests";
  {
    DigestMemory memory(file);
    memory.keep("/srv/a b", old);
    ASSERT_TRUE(memory.save());
  }
  const DigestMemory memory(file);
  EXPECT_EQ(memory.find("/srv/a b", old.stamp), old.sha256);
  EXPECT_EQ(memory.find("/srv/a", old.stamp), std::nullopt);
  for (int field = 0; field < 4; ++field) {
    FileStamp stamp = old.stamp;
    ++(field == 0 ? stamp.inode : stamp.bytes);
    if (field == 2) ++stamp.modified_ns;
    if (field == 3) ++stamp.changed_ns;
    EXPECT_EQ(memory.find("/srv/a b", stamp), std::nullopt);
  }
}

TEST_F(SceneListingTest, does_not_cache_files_that_were_just_changed) {
  DigestMemory memory{fs::path()};
  // Its change time is now, whatever its modification time is.
  fs::last_write_time(folder / "walls.ply", fs::file_time_type::clock::now() - std::chrono::hours(1));
  const auto hashed = hash_file(folder / "walls.ply", [](std::uint64_t) { return true; });
  ASSERT_TRUE(hashed);
  memory.keep(folder / "walls.ply", *hashed);
  EXPECT_EQ(memory.find(folder / "walls.ply", hashed->stamp), std::nullopt);
}

TEST_F(SceneListingTest, forgets_what_it_cannot_read) {
  const fs::path file = temporary.path() / "digests";
  const std::string sum(64, 'a');
  write_bytes(file, "rubbish\n" + sum + " 1 2 3\n" + sum + " 1 2 3 4 /srv/x\nshort 1 2 3 4 /srv/y\n\n");
  const DigestMemory memory(file);
  EXPECT_EQ(memory.find("/srv/x", {1, 2, 3, 4}), sum);
  EXPECT_EQ(memory.find("/srv/y", {1, 2, 3, 4}), std::nullopt);
}

TEST_F(SceneListingTest, trusts_its_cache_while_a_files_stamp_is_unchanged) {
  const FileStamp stamp = open_stamped(folder / "walls.ply")->stamp;
  const fs::path file = temporary.path() / "digests";
  write_bytes(file, fmt::format("{} {} {} {} {} {}\n", std::string(64, 'c'), stamp.inode, stamp.bytes,
                                stamp.modified_ns, stamp.changed_ns, (folder / "walls.ply").string()));
  DigestMemory known(file);
  const auto listed = list(folder, &known);
  ASSERT_TRUE(listed);
  EXPECT_EQ(listed->files.back().sha256, std::string(64, 'c'));
}

}  // namespace
}  // namespace cyclorama::scene_distribution

// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tidy/tidy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "common/base/file.h"

namespace cyclorama {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::string> names(const std::vector<TidyEntry>& entries) {
  std::vector<std::string> all;
  for (const TidyEntry& entry : entries) all.push_back(entry.name);
  return all;
}

const std::vector<TidyEntry> kFour{
    {"newest", 10, 400, false}, {"oldest", 10, 100, false}, {"new", 10, 300, false}, {"old", 10, 200, false}};

TEST(Tidy, removes_the_oldest_until_it_is_enough) {
  EXPECT_THAT(names(too_much(kFour, {40, 0, 2}, 0)), IsEmpty());
  EXPECT_THAT(names(too_much(kFour, {39, 0, 2}, 0)), ElementsAre("oldest"));
  EXPECT_THAT(names(too_much(kFour, {25, 0, 2}, 0)), ElementsAre("oldest", "old"));
  EXPECT_THAT(names(too_much(kFour, {1, 0, 2}, 0)), ElementsAre("oldest", "old")) << "two stay, whatever they take";
  EXPECT_THAT(names(too_much(kFour, {1, 0, 0}, 0)), ElementsAre("oldest", "old", "new", "newest"));
  EXPECT_THAT(names(too_much(kFour, {0, 0, 0}, 0)), IsEmpty());
}

TEST(Tidy, makes_room_on_a_disk_that_is_full) {
  EXPECT_THAT(names(too_much(kFour, {0, 100, 1}, 100)), IsEmpty());
  EXPECT_THAT(names(too_much(kFour, {0, 100, 1}, 85)), ElementsAre("oldest", "old"));
}

TEST(Tidy, never_removes_what_is_in_use_nor_more_than_it_must) {
  std::mt19937 random(8);
  for (int round = 0; round < 2000; ++round) {
    std::vector<TidyEntry> entries(random() % 9);
    std::uint64_t all = 0;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      entries[i] = {std::to_string(i), random() % 50, static_cast<std::int64_t>(random() % 5), random() % 3 == 0};
      all += entries[i].bytes;
    }
    const TidyLimits limits{1 + random() % 100, random() % 60, random() % 4};
    const std::uint64_t free_bytes = random() % 60;
    const auto go = too_much(entries, limits, free_bytes);
    std::uint64_t gone = 0;
    for (std::size_t i = 0; i < go.size(); ++i) {
      EXPECT_FALSE(go[i].is_in_use);
      EXPECT_TRUE(all - gone > limits.most_bytes || free_bytes + gone < limits.least_free) << "it was enough";
      EXPECT_GE(go[i].changed_s, go[i > 0 ? i - 1 : 0].changed_s);
      gone += go[i].bytes;
    }
    const auto may_go = std::count_if(entries.begin(), entries.end(), [](const TidyEntry& e) { return !e.is_in_use; });
    EXPECT_LE(go.size() + std::min(limits.keep, static_cast<std::size_t>(may_go)), static_cast<std::size_t>(may_go));
  }
}

TEST(Tidy, knows_from_links_what_is_in_use_and_follows_none_of_them) {
  std::string name = (fs::temp_directory_path() / "tidy-XXXXXX").string();
  ASSERT_NE(::mkdtemp(name.data()), nullptr);
  const fs::path root = name;
  const fs::path folder = root / "calibrations";
  for (const char* const one : {"1", "2", "3", "4"}) {
    fs::create_directories(folder / one);
    ASSERT_TRUE(write_file_atomically(folder / one / "photo", std::string_view(std::string(20'000, 'x'))));
    fs::last_write_time(folder / one / "photo", fs::file_time_type::clock::now() - std::chrono::hours(50 - *one));
  }
  fs::create_directories(root / "elsewhere");
  ASSERT_TRUE(write_file_atomically(root / "elsewhere" / "photo", std::string_view("x")));
  fs::create_directory_symlink("1", folder / "current");
  fs::create_directory_symlink("calibrations/2", root / "previous");
  fs::create_directory_symlink(root / "elsewhere", folder / "4" / "link");
  const auto seen = tidy(folder, {1, 0, 1}, true);
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->size(), 1u);
  const auto gone = tidy(folder, {1, 0, 0}, false);
  ASSERT_TRUE(gone);
  EXPECT_EQ(gone->size(), 2u);
  EXPECT_TRUE(fs::exists(folder / "1" / "photo"));
  EXPECT_TRUE(fs::exists(folder / "2" / "photo"));
  EXPECT_FALSE(fs::exists(folder / "3"));
  EXPECT_FALSE(fs::exists(folder / "4"));
  EXPECT_TRUE(fs::exists(root / "elsewhere" / "photo")) << "what a link leads to is not its folder's";
  const auto none = tidy(root / "nowhere", {1, 0, 0}, false);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code(), ErrorCode::kNotFound);
  fs::remove_all(root);
}

}  // namespace
}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
#include "kiosk/setup/setup_draft.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/base/file.h"

namespace cyclorama::setup {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Draft : public testing::Test {
 protected:
  Draft() {
    std::string pattern = fs::temp_directory_path() / "setup_draft_XXXXXX";
    file_ = fs::path(::mkdtemp(pattern.data())) / "setup.json";
  }
  ~Draft() override { fs::remove_all(file_.parent_path()); }

  fs::path file_;
};

TEST_F(Draft, goes_on_where_it_was_left) {
  {
    SetupDraft draft(file_);
    EXPECT_EQ(draft.step("wall").revision, 0);
    EXPECT_EQ(*draft.save("wall", 0, {{"radius_m", "3,2"}}, "192.0.2.30", "10:02"), 1);
    EXPECT_EQ(*draft.save("wall", 1, {{"radius_m", "3,25"}}, "192.0.2.30", "10:03"), 2);
  }
  const SetupDraft again(file_);
  EXPECT_EQ(again.step("wall").revision, 2);
  EXPECT_EQ(again.step("wall").fields.at("radius_m"), "3,25");
  EXPECT_EQ(again.damage(), "");
}

TEST_F(Draft, lets_nobody_overwrite_what_somebody_else_has_typed_meanwhile) {
  SetupDraft draft(file_);
  ASSERT_TRUE(draft.save("name", 0, {{"museum", "Hall 3"}}, "192.0.2.30", "10:02"));
  const auto late = draft.save("name", 0, {{"museum", "Hall 4"}}, "192.0.2.31", "10:03");
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().code(), ErrorCode::kBusy);
  EXPECT_THAT(late.error().message(), HasSubstr("192.0.2.30 has changed this step at 10:02"));
  EXPECT_EQ(draft.step("name").fields.at("museum"), "Hall 3");
  EXPECT_TRUE(draft.save("wall", 0, {}, "192.0.2.31", "10:03")) << "another step is another matter";
}

TEST_F(Draft, begins_anew_after_damage_and_keeps_the_damaged_file) {
  for (const char* const text :
       {"{", "[]", R"({"wall": 1})", R"({"wall": {"revision": -1, "fields": {}}})",
        R"({"wall": {"revision": 1e99, "fields": {}}})", R"({"wall": {"revision": 1, "fields": {"a": 1}}})"}) {
    ASSERT_TRUE(write_file_atomically(file_, std::string_view(text)));
    SetupDraft draft(file_);
    EXPECT_THAT(draft.damage(), HasSubstr("cannot be read any more")) << text;
    EXPECT_TRUE(draft.steps().empty());
    EXPECT_TRUE(fs::exists(file_.string() + ".damaged"));
    EXPECT_TRUE(draft.save("wall", 0, {}, "a", "b"));
  }
}

TEST_F(Draft, changes_nothing_when_the_disk_fails) {
  fs::create_directories(file_.parent_path() / "gone");
  SetupDraft draft(file_.parent_path() / "gone/setup.json");
  ASSERT_TRUE(draft.save("name", 0, {{"museum", "Hall 3"}}, "a", "b"));
  fs::remove_all(file_.parent_path() / "gone");
  EXPECT_FALSE(draft.save("name", 1, {{"museum", "Hall 4"}}, "a", "b"));
  EXPECT_EQ(draft.step("name").fields.at("museum"), "Hall 3");
  EXPECT_EQ(draft.step("name").revision, 1);
}

TEST_F(Draft, refuses_fields_without_end) {
  SetupDraft draft(file_);
  EXPECT_FALSE(draft.save("name", 0, {{"museum", std::string(501, 'x')}}, "a", "b"));
  Fields many;
  for (int i = 0; i < 201; ++i) many[std::to_string(i)] = "";
  EXPECT_FALSE(draft.save("name", 0, many, "a", "b"));
}

}  // namespace
}  // namespace cyclorama::setup

// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/plan/tour_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "common/base/file.h"

namespace cyclorama::tour {
namespace {

using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

class TourFolders : public testing::Test {
 protected:
  TourFolders() {
    fs::remove_all(path);
    fs::create_directories(path);
    auto made = WalkableArea::make({{-5, -5}, {5, -5}, {5, 5}, {-5, 5}});
    CHECK(made);
    area = *std::move(made);
    otherwise.languages = {"de"};
    otherwise.stops.push_back({{"", {1, 1}, 0.0, "altar"}, {}, {}, true, {}});
  }
  ~TourFolders() override { fs::remove_all(path); }
  [[nodiscard]] std::string text() const {
    const auto read = folder.read();
    return read ? *read : "none";
  }
  Result<std::string> add(const std::string& name, const std::string& title, const Eigen::Vector2d& at) {
    PlannedStop planned;
    planned.stop.name = name;
    planned.stop.position_m = at;
    if (!title.empty()) planned.title = {{"", title}};
    return folder.add(std::move(planned), otherwise, *area);
  }

  const fs::path path = fs::temp_directory_path() /
                        (std::string("tour_folder_") + testing::UnitTest::GetInstance()->current_test_info()->name());
  TourFolder folder{path};
  std::optional<WalkableArea> area;
  TourPlan otherwise;
};

TEST_F(TourFolders, begin_with_the_scenes_stops_and_keep_what_the_curator_wrote) {
  const auto first = add("", "Am Brunnen", {0.12345, -2});
  ASSERT_TRUE(first) << first.error().message();
  EXPECT_EQ(*first, "stop-1");
  EXPECT_THAT(text(), HasSubstr("name = \"altar\""));
  EXPECT_THAT(text(), HasSubstr("position_m = [0.123, -2"));
  EXPECT_THAT(text(), HasSubstr("de = \"Am Brunnen\""));
  ASSERT_TRUE(write_file_atomically(folder.file(), "# My notes\n" + text()));
  const auto second = add("", "", {1, -2});
  ASSERT_TRUE(second) << second.error().message();
  EXPECT_EQ(*second, "stop-2");
  EXPECT_THAT(text(), HasSubstr("# My notes\n"));
  ASSERT_TRUE(parse_tour_plan(text(), "tour.toml", &*area));
}

TEST_F(TourFolders, begin_with_nothing_in_a_scene_without_stops) {
  otherwise.stops.clear();
  ASSERT_TRUE(add("", "", {0, 0}));
  const auto plan = parse_tour_plan(text(), "tour.toml", &*area);
  ASSERT_TRUE(plan) << plan.error().message();
  EXPECT_EQ(plan->stops.size(), 1u);
}

TEST_F(TourFolders, undo_the_last_change_and_the_undoing) {
  EXPECT_EQ(folder.undo().error().code(), ErrorCode::kNotFound);
  ASSERT_TRUE(add("a", "", {0, 0}));
  ASSERT_TRUE(add("b", "", {1, 0}));
  ASSERT_TRUE(folder.undo());
  EXPECT_THAT(text(), Not(HasSubstr("\"b\"")));
  ASSERT_TRUE(folder.undo());
  EXPECT_THAT(text(), HasSubstr("\"b\""));
}

TEST_F(TourFolders, undo_the_first_stop_to_no_tour_at_all) {
  ASSERT_TRUE(add("a", "", {0, 0}));
  ASSERT_TRUE(folder.undo());
  EXPECT_EQ(text(), "none");
  ASSERT_TRUE(folder.undo());
  EXPECT_THAT(text(), HasSubstr("\"a\""));
}

TEST_F(TourFolders, refuse_what_would_make_no_tour_and_change_nothing) {
  ASSERT_TRUE(add("a", "", {0, 0}));
  const std::string before = text();
  EXPECT_EQ(add("a", "", {1, 0}).error().code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(add("A b", "", {1, 0}).error().code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(add("b", std::string(500, 'x'), {1, 0}).error().message(), HasSubstr("at most 200"));
  EXPECT_THAT(add("b", "", {9, 0}).error().message(), HasSubstr("nearest place"));
  EXPECT_EQ(text(), before);
  ASSERT_TRUE(write_file_atomically(folder.file(), std::string_view("version = 1\nstop = 3\n")));
  EXPECT_EQ(add("b", "", {1, 0}).error().code(), ErrorCode::kBadData);
  EXPECT_EQ(text(), "version = 1\nstop = 3\n");
}

}  // namespace
}  // namespace cyclorama::tour

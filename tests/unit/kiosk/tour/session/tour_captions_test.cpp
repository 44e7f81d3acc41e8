// SPDX-License-Identifier: Apache-2.0
/// Tests of what a visit writes on the wall, over real gRPC on [::1], with a fake farm and displays.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>

#include "common/base/file.h"
#include "tests/doubles/fake_display.h"
#include "tests/support/tour_process.h"

namespace cyclorama::tour {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr const char* kStops =
    "[limits]\nreduced_motion = true\n"
    "[[stop]]\nname = \"door\"\nposition_m = [0.0, 1.0]\nheading_deg = 0\n[stop.title]\nen = \"Door\"\nar = \"الباب\"\n"
    "[[stop]]\nname = \"well\"\nposition_m = [4.0, -4.0]\nheading_deg = 90\n";
const std::string kHead = "version = 1\nlanguages = [\"en\", \"ar\"]\n";

class TourCaptions : public testing::Test {
 protected:
  TourCaptions() {
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  ~TourCaptions() override { fs::remove_all(folder); }
  void write(const std::string& text, const char* name = "tour.toml") {
    ASSERT_TRUE(write_file_atomically(folder / name, text));
  }
  [[nodiscard]] TourSettings settings(const FakeFarm& farm) const {
    TourSettings settings = settings_for(farm);
    settings.tour_folder = folder;
    return settings;
  }
  static bool go(TourProcess& tour, const std::string& stop) {
    wire::GoToStopRequest request;
    request.set_name(stop);
    return tour.eventually([&] { return tour->go_to_stop(request).has_value(); });
  }
  static auto set(TourProcess& tour, const std::vector<std::string>& languages) {
    wire::SetCaptionsRequest request;
    request.mutable_languages()->Assign(languages.begin(), languages.end());
    return tour->set_captions(request);
  }
  /// Waits until the newest caption fulfils the condition.
  static bool shows(FakeDisplay& display, const std::function<bool(const wire::Caption&)>& condition) {
    return display.wait_until([&](const auto& d) { return !d.captions().empty() && condition(d.captions().back()); });
  }
  static bool is_written(const wire::Caption& caption) { return caption.width_px() > 0; }

  const fs::path folder = fs::temp_directory_path() / (std::string("tour_captions_") +
                                                       testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(TourCaptions, are_written_where_the_visitor_arrives_and_cleared_where_there_are_none) {
  write(kHead + "[captions]\n" + kStops);
  FakeFarm farm;
  TourProcess tour(settings(farm));
  FakeDisplay display(tour.address());
  ASSERT_TRUE(go(tour, "door"));
  ASSERT_TRUE(shows(display, is_written));
  FakeDisplay later(tour.address());
  EXPECT_TRUE(shows(later, is_written)) << "a display that joins is told";
  ASSERT_TRUE(go(tour, "well"));
  EXPECT_TRUE(shows(display, [](const auto& caption) { return !is_written(caption); })) << "it has no text";
  display.leave();
  EXPECT_THAT(display.wrongs(), testing::IsEmpty());
}

TEST_F(TourCaptions, are_in_the_languages_that_somebody_chooses) {
  write(kHead + "[captions]\n" + kStops);
  FakeFarm farm;
  TourProcess tour(settings(farm));
  FakeDisplay display(tour.address());
  ASSERT_TRUE(go(tour, "door"));
  std::string english;
  ASSERT_TRUE(shows(display, [&](const auto& caption) {
    english = caption.ink();
    return is_written(caption);
  }));
  EXPECT_THAT(tour->list_stops()->caption_languages(), ElementsAre("en"));
  ASSERT_TRUE(set(tour, {"ar"}));
  ASSERT_TRUE(shows(display, [&](const auto& caption) { return is_written(caption) && caption.ink() != english; }));
  std::uint32_t height = 0;
  shows(display, [&](const auto& caption) {
    height = caption.height_px();
    return true;
  });
  ASSERT_TRUE(set(tour, {"en", "ar"}));
  EXPECT_TRUE(shows(display, [&](const auto& caption) { return caption.height_px() > 3 * height / 2; }));
  ASSERT_TRUE(set(tour, {}));
  EXPECT_TRUE(shows(display, [](const auto& caption) { return !is_written(caption); }));

  EXPECT_THAT(set(tour, {"fr"}).error().message(), HasSubstr("no language 'fr', but en, ar"));
  EXPECT_EQ(set(tour, {"en", "ar", "en"}).error().code(), ErrorCode::kInvalidArgument);
  wire::SetCaptionsRequest next;
  next.set_next(true);
  EXPECT_THAT(tour->set_captions(next)->languages(), ElementsAre("en"));
  EXPECT_THAT(tour->set_captions(next)->languages(), ElementsAre("ar"));
  EXPECT_THAT(tour->set_captions(next)->languages(), testing::IsEmpty()) << "after the last comes none";
}

TEST_F(TourCaptions, follow_the_back_of_the_wand_once_for_each_turn) {
  write(kHead + "[captions]\n" + kStops);
  FakeFarm farm;
  TourProcess tour(settings(farm));
  ASSERT_TRUE(go(tour, "door"));
  wire::TrackedPose pose;
  pose.set_back(true);
  for (int i = 0; i < 5; ++i) tour->on_pose(1, pose);
  EXPECT_THAT(tour->list_stops()->caption_languages(), ElementsAre("ar"));
}

TEST_F(TourCaptions, follow_the_times_of_a_webvtt_file_and_its_changes) {
  write(kHead + "[captions]\n" + kStops + "[stop.captions]\nen = \"well.vtt\"\n");
  write("WEBVTT\n\n00:00.200 --> 00:00.700\nspoken\n", "well.vtt");
  FakeFarm farm;
  TourProcess tour(settings(farm));
  FakeDisplay display(tour.address());
  ASSERT_TRUE(go(tour, "well"));
  EXPECT_TRUE(shows(display, is_written));
  EXPECT_TRUE(shows(display, [](const auto& caption) { return !is_written(caption); }));

  write("WEBVTT\n\n00:00.200 --> 00:00.100\nspoken\n", "well.vtt");
  tour->read_plan();
  EXPECT_THAT(tour->list_stops()->problem(), HasSubstr("well.vtt:3: the caption ends before it begins"));
  EXPECT_TRUE(tour->list_stops()->has_captions()) << "the tour of before stays";
  write("WEBVTT\n\n00:00.000 --> 10:00.000\nspoken\n", "well.vtt");
  // The file system's clock may not have moved since the last change.
  std::filesystem::last_write_time(folder / "well.vtt", std::filesystem::file_time_type::clock::now() + 1s);
  tour->read_plan();
  EXPECT_EQ(tour->list_stops()->problem(), "");
}

TEST_F(TourCaptions, of_a_tour_without_them_cost_nothing) {
  write(kHead + kStops);
  FakeFarm farm;
  TourProcess tour(settings(farm));
  FakeDisplay display(tour.address());
  ASSERT_TRUE(go(tour, "door"));
  ASSERT_TRUE(display.wait_for_frames(2));
  display.leave();
  EXPECT_THAT(display.captions(), testing::IsEmpty());
  EXPECT_THAT(set(tour, {"en"}).error().message(), HasSubstr("give its tour.toml a table [captions]"));
}

}  // namespace
}  // namespace cyclorama::tour

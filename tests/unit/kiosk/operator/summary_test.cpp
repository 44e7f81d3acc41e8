// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/summary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "common/base/file.h"
#include "kiosk/operator/picture_check.h"
#include "tests/doubles/fake_process.h"

namespace cyclorama::operations {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A museum without any problem; tests break one part.
struct Museum {
  std::optional<FakeProcess> tour{std::in_place, "tour"};
  std::optional<FakeProcess> display{std::in_place, "display"};
  std::optional<FakeProcess> tracker{std::in_place, "tracker"};
  std::optional<FakeProcess> room{std::in_place, "simulated-room"};
  std::optional<Recording> recording;
  RecordedSpan span{10.0, 100.0, 590.0, 1.0, 12.5};
  TimePoint now{100s};

  Museum() {
    auto links = make_links({{"tour", tour->address()},
                             {"display", display->address()},
                             {"tracker", tracker->address()},
                             {"simulated-room", room->address()}});
    CHECK(links);
    recording.emplace(*std::move(links));
    tour->inspection.set_fact("scene", "grotto");
    tour->inspection.set_fact("title", "The grotto");
    tour->inspection.set_fact("triangles", "6000000");
    tour->inspection.set_gauge("nodes", 2);
    tour->inspection.set_gauge("frames", 1);
    tour->inspection.set_gauge("dropped: a node was lost", 2);
    tour->inspection.add_stage_time("draw", 3ms);
    tour->inspection.add_stage_time("steer", 3ms);
    tour->inspection.set_gauge("picture_scale", 0.75);
    tour->inspection.set_gauge("samples_per_pixel", 4);
    tour->inspection.set_gauge("wasted_frames_share", 0.01);
    display->inspection.set_gauge("poses_shown", 590.0);
    display->inspection.set_gauge("eye_missed_m", 0.25);
    display->inspection.set_picture("panorama", ramp_picture(0));
    display->inspection.set_picture("projector/left", ramp_picture(5));
    tracker->inspection.set_picture("camera", ramp_picture(7));
    room->inspection.set_picture("wall", ramp_picture(9));
  }
  void look() {
    recording->look(now);
    now += 1s;
  }
  void move() {
    display->inspection.set_picture("panorama", ramp_picture(20));
    room->inspection.set_picture("wall", ramp_picture(30));
  }
  [[nodiscard]] std::vector<std::string> problems() const { return problems_of(*recording, span); }
};

TEST(Summary, finds_no_problem_when_all_is_well) {
  Museum museum;
  museum.look();
  museum.recording->begin();
  museum.move();
  museum.look();
  EXPECT_THAT(museum.problems(), IsEmpty());
}

TEST(Summary, counts_refreshes_with_a_new_pose_as_the_display_does) {
  Museum museum;
  museum.look();
  EXPECT_EQ(museum.recording->poses(), 590.0);
}

TEST(Summary, has_the_demos_figures_in_the_order_of_a_frame) {
  Museum museum;
  museum.look();
  const auto json = nlohmann::ordered_json::parse(summary_json(*museum.recording, museum.span, {"one thing"}));
  EXPECT_EQ(json["scene"], "grotto");
  EXPECT_EQ(json["triangles"], 6'000'000);
  EXPECT_EQ(json["nodes"], 2);
  EXPECT_EQ(json["frames"], 100);
  EXPECT_EQ(json["fps"], 10.0);
  EXPECT_EQ(json["shown_hz"], 59.0);
  EXPECT_EQ(json["eye_missed_m"], 0.25);
  EXPECT_EQ(json["scale"], 0.75);
  EXPECT_EQ(json["samples"], 4);
  EXPECT_EQ(json["wasted"], 0.01);
  EXPECT_EQ(json["first_picture_s"], 12.5);
  EXPECT_EQ(json["drops"]["a node was lost"], 2);
  EXPECT_EQ(json["stages"].begin().key(), "steer");
  EXPECT_EQ(json["stages"]["draw"]["count"], 1);
  EXPECT_EQ(json["processes"]["tracker"]["healthy"], true);
  EXPECT_EQ(json["ok"], false);
  EXPECT_EQ(json["problems"][0], "one thing");
}

TEST(Summary, counts_the_farms_nodes_not_those_of_the_last_frame) {
  FakeProcess tour("tour");
  FakeProcess farm("coordinator");
  tour.inspection.set_gauge("nodes", 1);
  farm.inspection.set_gauge("nodes", 2);
  auto links = make_links({{"tour", tour.address()}, {"coordinator", farm.address()}});
  ASSERT_TRUE(links);
  Recording recording(*std::move(links));
  recording.look(TimePoint{1s});
  const auto json = nlohmann::json::parse(summary_json(recording, RecordedSpan{}, {}));
  EXPECT_EQ(json["nodes"], 2);
}

TEST(Summary, names_each_part_that_did_not_work) {
  {
    Museum museum;
    museum.look();
    museum.move();
    museum.look();
    museum.span.frames = 0;
    EXPECT_THAT(museum.problems(), ElementsAre(HasSubstr("0 frames were presented")));
  }
  {
    Museum frozen;
    frozen.look();
    frozen.look();
    EXPECT_THAT(frozen.problems(), ElementsAre(HasSubstr("'panorama' of display is frozen"),
                                               HasSubstr("'wall' of simulated-room is frozen")));
  }
  {
    Museum blank;
    blank.look();
    blank.move();
    blank.room->inspection.set_picture("wall", std::make_shared<RgbImage>(64, 32));
    blank.look();
    EXPECT_THAT(blank.problems(), ElementsAre(HasSubstr("'wall' of simulated-room is blank")));
  }
  {
    Museum unwell;
    unwell.look();
    unwell.move();
    unwell.display->inspection.set_state("A projector is dark; switch it on.", false);
    unwell.look();
    EXPECT_THAT(unwell.problems(), ElementsAre(HasSubstr("display is not well: A projector is dark")));
  }
  {
    Museum away;
    away.look();
    away.move();
    away.look();
    away.tracker.reset();
    away.look();
    EXPECT_THAT(away.problems(), ElementsAre(HasSubstr("tracker is away")));
  }
}

TEST(Summary, reports_a_process_that_was_away_for_a_while) {
  Museum museum;
  museum.look();
  museum.move();
  const int port = museum.tracker->port();
  museum.tracker.reset();
  for (int i = 0; i < 6; ++i) museum.look();
  museum.tracker.emplace("tracker", port);
  museum.tracker->inspection.set_picture("camera", ramp_picture(7));
  // The channel reconnects with a back-off.
  for (int i = 0; i < 100'000 && museum.recording->processes()[2].last.away; ++i) museum.look();
  EXPECT_THAT(museum.problems(), ElementsAre(HasSubstr("tracker did not answer for")));
}

TEST(Summary, reports_that_no_tag_was_ever_followed) {
  FakeProcess tour("tour");
  FakeProcess tracker("tracker");
  tracker.inspection.set_picture("camera", ramp_picture(1));
  auto links = make_links({{"tour", tour.address()}, {"tracker", tracker.address()}});
  ASSERT_TRUE(links);
  Recording recording(*std::move(links));
  recording.look(TimePoint(1s));
  EXPECT_THAT(problems_of(recording, {10.0, 100.0, 590.0, 1.0, std::nullopt}),
              ElementsAre(HasSubstr("no view ever followed a tag")));
}

TEST(Summary, is_written_with_its_pictures) {
  Museum museum;
  museum.look();
  museum.recording->tick();
  museum.move();
  museum.look();
  museum.recording->tick();
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "recording" / "deep";
  const Status written = write_recording(*museum.recording, folder, "{}\n");
  ASSERT_TRUE(written) << written.error().message();
  for (const char* const name :
       {"panorama.png", "projector-left.png", "wall.png", "camera.png", "wall-over-time.png", "summary.json"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
  }
}

TEST(PictureCheck, distinguishes_blank_from_dark) {
  RgbImage dark(100, 100);
  EXPECT_TRUE(is_blank(dark));
  EXPECT_TRUE(is_blank(RgbImage()));
  for (int i = 0; i < 100; ++i) dark.at(i, 50)[1] = 40;  // The light of one lamp.
  EXPECT_FALSE(is_blank(dark));
  EXPECT_TRUE(is_blank(RgbImage(50, 50, 200)));
}

TEST(PictureCheck, measures_how_much_changed_above_noise) {
  const RgbImage before(10, 10, 100);
  RgbImage after = before;
  for (auto& value : after.data()) value = static_cast<std::uint8_t>(value + 5);
  EXPECT_EQ(changed_share(before, after), 0.0);
  after.at(3, 3)[2] = 200;
  EXPECT_DOUBLE_EQ(changed_share(before, after), 0.01);
  EXPECT_EQ(changed_share(before, RgbImage(9, 10)), 1.0);
}

TEST(PictureCheck, shrinks_by_averaging) {
  RgbImage stripes(100, 40);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 100; x += 2) std::fill_n(stripes.at(x, y), 3, std::uint8_t{200});
  }
  const RgbImage small = shrunk(stripes, 50);
  EXPECT_EQ(small.width(), 50);
  EXPECT_EQ(small.height(), 20);
  EXPECT_EQ(small.at(7, 7)[0], 100);
  EXPECT_EQ(shrunk(stripes, 500), stripes);
}

TEST(PictureCheck, arranges_pictures_side_by_side) {
  const RgbImage sheet =
      contact_sheet({{RgbImage(40, 20, 255), RgbImage(80, 20, 255)}, {RgbImage()}, {RgbImage(4, 90, 255)}}, 40);
  EXPECT_EQ(sheet.width(), 2 * 44 + 4);
  EXPECT_EQ(sheet.at(4, 4)[0], 255);
  EXPECT_LT(sheet.at(0, 0)[0], 30);
  EXPECT_EQ(contact_sheet({}, 40).width(), 4);
}

}  // namespace
}  // namespace cyclorama::operations

// SPDX-License-Identifier: Apache-2.0
/// Tests of the stops of a visit over real gRPC on [::1], with a fake farm and displays.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>

#include "common/base/file.h"
#include "tests/doubles/fake_display.h"
#include "tests/support/tour_process.h"

namespace cyclorama::tour {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr const char* kTour =
    "version = 1\nlanguages = [\"en\", \"de\"]\n[title]\nen = \"The room\"\n"
    "[[stop]]\nname = \"door\"\nposition_m = [0.0, 1.0]\nheading_deg = 0\n"
    "[stop.title]\nen = \"Door\"\nde = \"Tür\"\n"
    "[[stop]]\nname = \"well\"\nposition_m = [4.0, -4.0]\nheading_deg = 90\n"
    "[[stop]]\nname = \"secret\"\nposition_m = [-6.0, 3.0]\nheading_deg = 0\nkeep = false\n";

class TourStops : public testing::Test {
 protected:
  TourStops() {
    fs::remove_all(folder);
    fs::create_directories(folder / "tour");
    write(kTour);
  }
  ~TourStops() override { fs::remove_all(folder); }
  void write(const std::string& text) { ASSERT_TRUE(write_file_atomically(folder / "tour" / "tour.toml", text)); }
  [[nodiscard]] TourSettings settings(const FakeFarm& farm) const {
    TourSettings settings = settings_for(farm);
    settings.tour_folder = folder / "tour";
    return settings;
  }
  [[nodiscard]] TourSettings keeping(const FakeFarm& farm) const {
    TourSettings keeps = settings(farm);
    keeps.pictures_folder = folder / "pictures";
    keeps.fetch_after = 0s;
    return keeps;
  }
  static wire::GoToStopRequest step(int step) {
    wire::GoToStopRequest request;
    request.set_step(step);
    return request;
  }
  static wire::GoToStopRequest named(const std::string& name) {
    wire::GoToStopRequest request;
    request.set_name(name);
    return request;
  }
  static bool is_listed(TourProcess& tour) {
    return tour.eventually([&] { return tour->list_stops().has_value(); });
  }

  const fs::path folder = fs::temp_directory_path() /
                          (std::string("tour_stops_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(TourStops, are_those_of_the_curator_and_the_visitor_is_led_to_them) {
  FakeFarm farm;
  TourProcess tour(settings(farm));
  FakeDisplay display(tour.address());
  ASSERT_TRUE(is_listed(tour));
  const auto list = tour->list_stops();
  EXPECT_EQ(list->tour_title(), "The room");
  ASSERT_EQ(list->stops_size(), 3);
  EXPECT_EQ(list->stops(0).titles().at("de"), "Tür");
  EXPECT_FALSE(list->has_at());

  const auto first = tour->go_to_stop(step(1));
  ASSERT_TRUE(first) << first.error().message();
  EXPECT_EQ(first->name(), "door") << "the nearest, since none was visited";
  EXPECT_TRUE(tour->list_stops()->is_led());
  EXPECT_TRUE(tour.eventually([&] { return !tour->list_stops()->is_led(); }));
  EXPECT_NEAR(tour.position()->position_m.y(), 1.0, 0.2) << "on foot";
  EXPECT_EQ(tour->go_to_stop(step(-1))->name(), "secret") << "before the first comes the last";
  EXPECT_EQ(tour->go_to_stop(named("well"))->name(), "well");
  EXPECT_EQ(tour->go_to_stop(named("cellar")).error().code(), ErrorCode::kNotFound);
  EXPECT_EQ(tour->go_to_stop(step(2)).error().code(), ErrorCode::kInvalidArgument);
}

TEST_F(TourStops, are_reached_by_a_soft_cut_with_reduced_motion) {
  write(std::string(kTour) + "[limits]\nreduced_motion = true\neye_height_m = 1.2\n");
  FakeFarm farm;
  TourProcess tour(settings(farm));
  FakeDisplay display(tour.address());
  ASSERT_TRUE(display.wait_for_frames(1));
  std::uint64_t cuts = 0;
  display.wait_until([&](const auto& d) {
    cuts = d.frames().back().cuts;
    return true;
  });
  ASSERT_TRUE(tour->go_to_stop(named("well")));
  EXPECT_EQ(tour.position()->position_m, Eigen::Vector2d(4.0, -4.0)) << "at once";
  ASSERT_TRUE(display.wait_until([&](const auto& d) { return d.frames().back().cuts == cuts + 1; }));
  display.leave();
  const wire::View& view = display.frames().back().view;
  EXPECT_EQ(view.eye_m().x(), 4.0);
  EXPECT_NEAR(view.eye_m().y(), 1.2, 1e-9) << "of a child";
  EXPECT_NEAR(view.heading_rad(), std::numbers::pi / 2, 1e-9);
  for (const auto& frame : display.frames()) EXPECT_EQ(frame.cuts, frame.view.eye_m().x() == 4.0 ? cuts + 1 : cuts);
  for (const wire::Heading& heading : display.headings()) {
    if (!heading.has_eye_m()) continue;
    EXPECT_EQ(heading.cuts(), heading.eye_m().x() == 4.0 ? cuts + 1 : cuts);
  }
}

TEST_F(TourStops, fade_the_lamps_that_they_set_and_a_person_may_fade_them_otherwise) {
  const std::string dark = "[[stop.lamps]]\ngroup = \"daylight\"\nlevel = 0\n";
  write(kTour + dark);  // The last stop's.
  wire::SceneDescription scene = fake_scene("plain");
  scene.add_lamp_groups("daylight");
  scene.add_lamp_groups("torch");
  FakeFarm farm(scene);
  TourProcess tour(settings(farm));
  FakeDisplay display(tour.address());
  ASSERT_TRUE(is_listed(tour));
  ASSERT_TRUE(farm.wait_for_views(1));
  EXPECT_EQ(farm.views().back().lamp_levels_size(), 0) << "as the scene describes them";
  const auto has_levels = [&](float daylight, float torch) {
    return tour.eventually([&] {
      const wire::View view = farm.views().back();
      return view.lamp_levels_size() == 2 && view.lamp_levels(0) == daylight && view.lamp_levels(1) == torch;
    });
  };
  ASSERT_TRUE(tour->go_to_stop(named("secret")));
  EXPECT_TRUE(has_levels(0.0f, 1.0f));
  std::set<float> seen;
  for (const wire::View& view : farm.views()) {
    if (view.lamp_levels_size() == 2) seen.insert(view.lamp_levels(0));
  }
  EXPECT_GT(seen.size(), 5u) << "softly";

  wire::SetLampsRequest request;
  (*request.mutable_levels())["torch"] = 2.0f;
  const auto set = tour->set_lamps(request);
  ASSERT_TRUE(set) << set.error().message();
  EXPECT_THAT(set->groups(), testing::ElementsAre("daylight", "torch"));
  EXPECT_TRUE(has_levels(0.0f, 2.0f));
  (*request.mutable_levels())["moon"] = 1.0f;
  EXPECT_EQ(tour->set_lamps(request).error().code(), ErrorCode::kNotFound);

  write(std::string(kTour) + "[[stop.lamps]]\ngroup = \"moon\"\nlevel = 1\n");
  tour->read_plan();
  EXPECT_THAT(tour->list_stops()->problem(), HasSubstr("sets the lamps 'moon', and 'plain' has daylight, torch"));
}

TEST_F(TourStops, stay_those_of_before_when_the_new_file_is_wrong) {
  FakeFarm farm;
  TourProcess tour(settings(farm));
  ASSERT_TRUE(is_listed(tour));
  write(std::string(kTour) + "[[stop]]\nname = \"wall\"\nposition_m = [30.0, 0.0]\nheading_deg = 0\n");
  tour->read_plan();
  auto list = tour->list_stops();
  EXPECT_EQ(list->stops_size(), 3);
  EXPECT_THAT(list->problem(), HasSubstr("tour.toml:23: stop[3].position_m"));
  EXPECT_THAT(list->problem(), HasSubstr("the nearest place is [9.99"));
  write(std::string("scene = \"elsewhere\"\n") + kTour);
  tour->read_plan();
  EXPECT_THAT(tour->list_stops()->problem(), HasSubstr("is a tour of 'elsewhere'"));
  write(kTour);
  tour->read_plan();
  EXPECT_EQ(tour->list_stops()->problem(), "");
  fs::remove(folder / "tour" / "tour.toml");
  tour->read_plan();
  EXPECT_EQ(tour->list_stops()->stops_size(), 0) << "the scene's own";
}

TEST_F(TourStops, are_added_where_the_visitor_stands_and_taken_back) {
  FakeFarm farm;
  TourProcess tour(settings(farm));
  ASSERT_TRUE(is_listed(tour));
  ASSERT_TRUE(tour.steer(0, 0, 1).ok());
  ASSERT_TRUE(tour.eventually([&] { return tour.gauge("heading_deg") > 1 && tour.gauge("turn_deg_per_s") == 0; }));
  wire::AddStopRequest request;
  request.set_title("Here");
  const auto added = tour->add_stop(request);
  ASSERT_TRUE(added) << added.error().message();
  auto list = tour->list_stops();
  ASSERT_EQ(list->stops_size(), 4);
  EXPECT_EQ(list->stops(3).name(), added->name());
  EXPECT_EQ(list->stops(3).titles().at("en"), "Here");
  ASSERT_TRUE(tour->undo_stop());
  EXPECT_EQ(tour->list_stops()->stops_size(), 3);
  TourSettings without = settings_for(farm);
  TourProcess other(without);
  EXPECT_EQ(other->add_stop(request).error().code(), ErrorCode::kNotFound);
  EXPECT_EQ(other->fetch_pictures().error().code(), ErrorCode::kNotFound);
}

TEST_F(TourStops, go_on_with_kept_pictures_while_the_farm_is_away_and_back_to_the_live_one) {
  auto farm = std::make_unique<FakeFarm>();
  const int port = farm->port();
  TourProcess tour(keeping(*farm));
  FakeDisplay display(tour.address());
  ASSERT_TRUE(display.wait_for_frames(1));
  ASSERT_TRUE(tour.eventually([&] { return tour.gauge("kept_stops") == 2; })) << "keep = false is obeyed";
  std::uint64_t cuts = 0;
  display.wait_until([&](const auto& d) {
    cuts = d.frames().back().cuts;
    return true;
  });

  // A view that the lost farm never answers is requested again from the next one; nobody may see its frame.
  const std::size_t views = farm->views().size();
  farm->set_gate(false);
  ASSERT_TRUE(farm->wait_for_views(views + 1));
  farm.reset();
  ASSERT_TRUE(
      display.wait_until([&](const auto& d) { return d.frames().back().cuts > cuts && d.frames().back().complete; }));
  EXPECT_EQ(tour.position()->position_m, Eigen::Vector2d(0.0, 1.0)) << "the nearest stop";
  EXPECT_TRUE(tour.eventually([&] { return tour.status().state().find("The visit goes on") != std::string::npos; }));
  ASSERT_TRUE(tour.steer(1, 0, 1).ok());
  EXPECT_TRUE(tour.eventually([&] { return tour.gauge("heading_deg") > 2; })) << "the visitor looks around";
  EXPECT_EQ(tour.position()->position_m, Eigen::Vector2d(0.0, 1.0)) << "but does not walk";
  EXPECT_EQ(tour->go_to_stop(step(1))->name(), "well");
  EXPECT_EQ(tour->go_to_stop(step(1))->name(), "door") << "past the stop that is not kept";
  EXPECT_EQ(tour->go_to_stop(named("secret")).error().code(), ErrorCode::kUnavailable);
  ASSERT_TRUE(display.wait_until([&](const auto& d) { return d.frames().back().cuts == cuts + 3; }));
  display.wait_until([&](const auto& d) {
    const auto picture = from_wire(d.frames().back().view.panorama());
    EXPECT_TRUE(picture && is_whole_turn(std::get<Panorama>(picture->shape)));
    EXPECT_FALSE(d.frames().back().view.depth());
    return true;
  });
  FakeDisplay late(tour.address());
  EXPECT_TRUE(late.wait_for_frames(1)) << "a display that joins meanwhile";

  farm = std::make_unique<FakeFarm>(fake_scene("plain"), port);
  ASSERT_TRUE(display.wait_until([&](const auto& d) { return d.frames().back().view.depth(); })) << "live again";
  EXPECT_TRUE(display.wait_until([&](const auto& d) { return d.frames().back().cuts == cuts + 5; }))
      << "by a cut, after one for the display that joined";
  display.leave();
  EXPECT_THAT(display.wrongs(), testing::IsEmpty());
  EXPECT_EQ(display.frames().back().view.eye_m().z(), 1.0);
}

TEST_F(TourStops, are_visited_without_any_farm_after_a_restart) {
  int port = 0;
  {
    FakeFarm farm;
    port = farm.port();
    TourProcess tour(keeping(farm));
    FakeDisplay display(tour.address());
    ASSERT_TRUE(tour.eventually([&] { return tour.gauge("kept_stops") == 2; }));
  }
  TourSettings alone = settings_for(FakeFarm());
  alone.coordinators = {"[::1]:" + std::to_string(port)};
  alone.tour_folder = folder / "tour";
  alone.pictures_folder = folder / "pictures";
  TourProcess tour(std::move(alone));
  FakeDisplay display(tour.address());
  EXPECT_TRUE(display.wait_for_frames(1));
  EXPECT_EQ(tour->go_to_stop(named("well"))->name(), "well");
  EXPECT_TRUE(display.wait_until([](const auto& d) { return d.frames().back().view.eye_m().x() == 4.0; }));
}

}  // namespace
}  // namespace cyclorama::tour

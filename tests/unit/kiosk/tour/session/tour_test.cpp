// SPDX-License-Identifier: Apache-2.0
/// Tests of the tour over real gRPC on [::1], with a fake farm, displays and trackers.
#include "kiosk/tour/session/tour.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "common/geometry/guard_band.h"
#include "kiosk/tour/navigation/walk_record.h"
#include "tests/doubles/fake_display.h"
#include "tests/doubles/fake_tracker.h"
#include "tests/support/tour_process.h"

namespace cyclorama::tour {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(Tour, shows_frames_on_a_display_with_a_guard_band) {
  FakeFarm farm;
  TourProcess tour(settings_for(farm));
  FakeDisplay display(tour.address());
  ASSERT_TRUE(display.wait_for_frames(2));
  display.leave();
  EXPECT_THAT(display.wrongs(), IsEmpty());
  const auto picture = from_wire(display.frames().front().view.panorama());
  ASSERT_TRUE(picture);
  EXPECT_EQ(*picture, with_guard_band(Projection{fake_wall(), {}}, default_guard_rad({}), walk_guard_rad({})));
  EXPECT_GT(picture->height_px(), fake_wall().height_px) << "rows for walking";
  EXPECT_TRUE(display.frames().front().view.depth());
  const auto shown = from_wire(display.headings().front().shown());
  ASSERT_TRUE(shown);
  EXPECT_EQ(*shown, (Projection{fake_wall(), {}}));
  EXPECT_EQ(display.frames().front().view.eye_m().y(), 1.6);
}

TEST(Tour, follows_the_tag_and_measures_every_stage_from_shutter_to_photon) {
  FakeFarm farm;
  TourProcess tour(settings_for(farm));
  FakeDisplay display(tour.address());
  FakeTracker tracker(tour.address());
  ASSERT_TRUE(display.wait_for_frames(1));
  while (!display.wait_until([](const auto& d) { return d.headings().back().heading_rad() > 0.3; }, 10ms)) {
    ASSERT_TRUE(tracker.see(1.0, 0.7));
  }
  display.wait_until([](const auto& d) { return d.headings().back().shutter_ns() != 0; });
  for (const char* const name : {"capture", "detect", "pose", "steer", "farm_round_trip", "plan", "render", "encode",
                                 "farm", "decode", "wait", "draw", "shutter_to_photon"}) {
    EXPECT_TRUE(tour.eventually([&] { return tour.stage_count(name) > 0; })) << name;
  }
  EXPECT_GT(tour.gauge("frames"), 0);
  EXPECT_GT(tour.gauge("bytes_per_frame"), 100);
  EXPECT_EQ(tour.gauge("balance_efficiency"), 1.0);
  EXPECT_TRUE(tour.eventually([&] { return tour.gauge("heading_deg") > 10; }));
  EXPECT_TRUE(tour.status().healthy()) << tour.status().state();
}

TEST(Tour, walks_with_keys_and_stops_when_they_are_released) {
  FakeFarm farm;
  TourProcess tour(settings_for(farm));
  FakeDisplay display(tour.address());
  ASSERT_TRUE(display.wait_for_frames(1));
  ASSERT_TRUE(tour.steer(1, 0, 0).ok());
  EXPECT_TRUE(tour.eventually([&] { return tour.gauge("eye_z_m") < -0.05; }));
  EXPECT_TRUE(tour.eventually([&] { return tour.gauge("forward_m_per_s") == 0.0; }));
  EXPECT_TRUE(farm.views().back().shutter_ns() == 0);
}

TEST(Tour, requests_neither_depth_nor_rows_where_nobody_can_walk) {
  wire::SceneDescription scene = fake_scene("a point");
  for (wire::GroundPoint& corner : *scene.mutable_walkable()) {
    corner.set_x_m(1e-3 * corner.x_m());
    corner.set_z_m(1e-3 * corner.z_m());
  }
  FakeFarm farm(scene);
  TourProcess tour(settings_for(farm));
  FakeDisplay display(tour.address());
  ASSERT_TRUE(display.wait_for_frames(1));
  EXPECT_FALSE(farm.views().back().depth());
  EXPECT_EQ(farm.views().back().panorama().height_px(), static_cast<std::uint32_t>(fake_wall().height_px));
}

/// Eye (x, z) and heading.
using Pose = std::array<double, 3>;
Pose pose_of(const wire::View& view) { return {view.eye_m().x(), view.eye_m().z(), view.heading_rad()}; }
Pose pose_of(const wire::Heading& heading) { return {heading.eye_m().x(), heading.eye_m().z(), heading.heading_rad()}; }

TEST(Tour, requests_views_of_where_the_visitor_will_be_and_tells_displays_where_the_visitor_is) {
  FakeFarm farm;
  farm.set_frame_time(60ms, 70ms);
  TourSettings settings = settings_for(farm);
  settings.record = true;
  TourProcess tour(settings);
  FakeDisplay display(tour.address());
  ASSERT_TRUE(display.wait_for_frames(1));
  // Straight ahead, so that the heading alone would tell displays nothing.
  EXPECT_TRUE(tour.eventually([&] {
    EXPECT_TRUE(tour.steer(1, 0, 0).ok());
    return tour.gauge("predicted_m") > 0.05;
  }));
  EXPECT_GT(tour.gauge("latency_ms"), 50.0);
  EXPECT_GT(tour.gauge("interval_ms"), 10.0);
  EXPECT_TRUE(tour.eventually([&] { return tour.gauge("forward_m_per_s") == 0.0; }));
  const SavedPosition rest = *tour.position();
  const Pose rest_pose{rest.position_m.x(), rest.position_m.y(), rest.heading_rad};
  EXPECT_TRUE(tour.eventually([&] { return pose_of(farm.views().back()) == rest_pose; }))
      << "the last view is of the very place";
  EXPECT_TRUE(display.wait_until([&](const auto& d) { return pose_of(d.headings().back()) == rest_pose; }));
  EXPECT_TRUE(tour.eventually([&] { return tour.gauge("predicted_m") == 0.0; }));
  tour.stop();
  display.leave();

  const auto record = parse_walk_record(tour.recording(), "visit.walk");
  ASSERT_TRUE(record) << record.error().message();
  std::set<Pose> walked;
  for (const WalkEntry& entry : record->entries) {
    if (entry.view) walked.insert({entry.view->position_m.x(), entry.view->position_m.y(), entry.view->heading_rad});
  }
  std::size_t of_the_present = 0;
  for (const wire::Heading& heading : display.headings()) {
    if (!heading.has_eye_m()) continue;  // Before the first scene.
    EXPECT_TRUE(walked.contains(pose_of(heading)));
    EXPECT_EQ(heading.eye_m().y(), 1.6);
    ++of_the_present;
  }
  EXPECT_GT(of_the_present, 10u);
  std::size_t of_the_future = 0;
  for (const wire::View& view : farm.views()) of_the_future += walked.contains(pose_of(view)) ? 0U : 1U;
  EXPECT_GT(of_the_future, 0u);
}

TEST(Tour, sends_no_heading_while_the_visitor_stands_still) {
  FakeFarm farm;
  TourProcess tour(settings_for(farm));
  FakeDisplay display(tour.address());
  ASSERT_TRUE(display.wait_for_frames(1));
  ASSERT_TRUE(display.wait_until([](const auto& d) { return d.headings().back().has_eye_m(); }));
  std::size_t before = 0;
  display.wait_until([&](const auto& d) {
    before = d.headings().size();
    return true;
  });
  EXPECT_FALSE(display.wait_until([&](const auto& d) { return d.headings().size() > before; }, 500ms));
}

TEST(Tour, records_a_walk_that_replays_bit_by_bit) {
  FakeFarm farm;
  TourSettings settings = settings_for(farm);
  settings.record = true;
  TourProcess tour(settings);
  FakeDisplay display(tour.address());
  FakeTracker tracker(tour.address());
  ASSERT_TRUE(display.wait_for_frames(1));
  while (!display.wait_until([](const auto& d) { return d.headings().back().heading_rad() > 0.3; }, 10ms)) {
    ASSERT_TRUE(tracker.see(1.0, 0.7));
  }
  ASSERT_TRUE(tour.steer(1, 0, 0).ok());
  EXPECT_TRUE(tour.eventually([&] { return tour.gauge("forward_m_per_s") > 0.1; }));
  tour.stop();
  const auto record = parse_walk_record(tour.recording(), "visit.walk");
  ASSERT_TRUE(record) << record.error().message();
  const WalkReplay replay = replayed(*record);
  EXPECT_FALSE(replay.difference) << *replay.difference;
  EXPECT_GT(replay.ticks, 10u);
  EXPECT_GT(replay.poses, 10u);
  EXPECT_GT(replay.peaks.turn_rad_per_s, 0.3);
}

TEST(Tour, resumes_at_the_visitors_position_after_a_restart) {
  FakeFarm farm;
  SavedPosition left;
  {
    TourProcess tour(settings_for(farm));
    FakeDisplay display(tour.address());
    ASSERT_TRUE(display.wait_for_frames(1));
    ASSERT_TRUE(tour.steer(1, 0, 1).ok());
    EXPECT_TRUE(tour.eventually([&] { return tour.gauge("eye_z_m") < -0.05 && tour.gauge("heading_deg") > 1; }));
    EXPECT_TRUE(tour.eventually([&] { return tour.gauge("forward_m_per_s") == 0.0; }));
    ASSERT_TRUE(tour.position());
    left = *tour.position();
  }
  const std::size_t views = farm.views().size();
  TourSettings settings = settings_for(farm);
  settings.resume = left;
  {
    TourProcess tour(settings);
    FakeDisplay display(tour.address());
    ASSERT_TRUE(display.wait_for_frames(1));
    EXPECT_EQ(farm.views()[views].eye_m().z(), left.position_m.y());
    EXPECT_EQ(farm.views()[views].heading_rad(), left.heading_rad);
    EXPECT_EQ(tour.position(), left);
  }
  // Another scene, and then a position inside a wall.
  settings.resume->scene = "another";
  TourProcess elsewhere(settings);
  EXPECT_TRUE(elsewhere.eventually([&] { return elsewhere.position().has_value(); }));
  EXPECT_EQ(elsewhere.position()->position_m, Eigen::Vector2d(0, 0));
  settings.resume = SavedPosition{left.scene, {1e5, 0.0}, 0.0};
  TourProcess inside(settings);
  EXPECT_TRUE(inside.eventually([&] { return inside.position().has_value(); }));
  EXPECT_NEAR(inside.position()->position_m.x(), 10.0, 0.1);
}

TEST(Tour, refuses_keys_out_of_range) {
  FakeFarm farm;
  TourProcess tour(settings_for(farm));
  for (const double value :
       {1.5, -1.01, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const grpc::Status status = tour.steer(0, value, 0);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    EXPECT_THAT(status.error_message(), HasSubstr("steer.right"));
  }
}

TEST(Tour, has_at_most_two_frames_in_flight_and_then_requests_the_newest_view) {
  FakeFarm farm;
  farm.set_gate(false);
  TourProcess tour(settings_for(farm));
  FakeDisplay display(tour.address());
  FakeTracker tracker(tour.address());
  ASSERT_TRUE(farm.wait_for_views(1));
  while (!display.wait_until(
      [](const auto& d) { return !d.headings().empty() && d.headings().back().heading_rad() > 0.5; }, 10ms)) {
    ASSERT_TRUE(tracker.see(1.0, 0.7));
  }
  EXPECT_EQ(farm.views().size(), 2u);
  EXPECT_LT(farm.views()[1].heading_rad(), 0.2);
  farm.set_gate(true);
  ASSERT_TRUE(farm.wait_for_views(3));
  EXPECT_GT(farm.views()[2].heading_rad(), 0.5) << "newest wins";
}

TEST(Tour, requests_one_frame_a_second_at_rest) {
  FakeFarm farm;
  TourProcess tour(settings_for(farm));
  FakeDisplay display(tour.address());
  ASSERT_TRUE(display.wait_for_frames(1));
  const TimePoint begin = SteadyClock().now();
  const std::size_t views = farm.views().size();
  // The first of them may follow at once: a display that joins after the first view causes a new request.
  ASSERT_TRUE(farm.wait_for_views(views + 3));
  EXPECT_GE(SteadyClock().now() - begin, 1900ms);
  EXPECT_TRUE(farm.views().back().shutter_ns() == 0);
}

TEST(Tour, requests_nothing_at_rest_from_a_farm_with_a_budget_until_a_display_needs_the_picture) {
  auto farm = std::make_unique<FakeFarm>();
  const int port = farm->port();
  TourSettings settings = settings_for(*farm);
  settings.picture.frame_budget_ms = 33.0;
  settings.picture.reference_samples = 256;
  TourProcess tour(std::move(settings));
  FakeDisplay display(tour.address());
  ASSERT_TRUE(display.wait_for_frames(1));
  EXPECT_EQ(farm->last_open().frame_budget_ms(), 33.0);
  EXPECT_EQ(farm->last_open().reference_samples(), 256u);
  const std::size_t views = farm->views().size();
  EXPECT_FALSE(farm->wait_for_views(views + 1, 1500ms));
  FakeDisplay second(tour.address());
  EXPECT_TRUE(second.wait_for_frames(1));
  farm.reset();
  ASSERT_TRUE(tour.eventually([&] { return !tour.status().healthy(); }));
  farm = std::make_unique<FakeFarm>(fake_scene("plain"), port);
  EXPECT_TRUE(farm->wait_for_views(1));
}

TEST(Tour, survives_a_farm_that_goes_away_and_comes_back) {
  auto farm = std::make_unique<FakeFarm>();
  const int port = farm->port();
  TourProcess tour(settings_for(*farm));
  FakeDisplay display(tour.address());
  ASSERT_TRUE(display.wait_for_frames(1));
  ASSERT_TRUE(tour.steer(0, 0, 1).ok());
  ASSERT_TRUE(tour.eventually([&] { return tour.gauge("heading_deg") > 5; }));
  farm.reset();
  ASSERT_TRUE(tour.eventually([&] { return !tour.status().healthy(); }));
  EXPECT_THAT(tour.status().state(), HasSubstr("The farm is away"));
  farm = std::make_unique<FakeFarm>(fake_scene("plain"), port);
  ASSERT_TRUE(farm->wait_for_views(2));
  EXPECT_GT(farm->views().back().heading_rad(), 0.08) << "the visitor stands where it stood";
  std::size_t before = 0;
  display.wait_until([&](const auto& d) {
    before = d.frames_complete();
    return true;
  });
  EXPECT_TRUE(display.wait_for_frames(before + 1));
  EXPECT_TRUE(tour.eventually([&] { return tour.status().healthy(); })) << tour.status().state();
}

TEST(Tour, ends_a_frame_that_the_farm_broke_off_and_continues) {
  FakeFarm farm;
  farm.break_next_frame_after(1);
  TourProcess tour(settings_for(farm));
  FakeDisplay display(tour.address());
  ASSERT_TRUE(display.wait_for_frames(2));
  display.leave();
  EXPECT_THAT(display.wrongs(), IsEmpty());
  EXPECT_TRUE(display.frames().front().ended);
  EXPECT_FALSE(display.frames().front().complete);
}

TEST(Tour, serves_displays_that_come_and_go) {
  FakeFarm farm;
  TourProcess tour(settings_for(farm));
  EXPECT_TRUE(tour.eventually([&] { return tour.status().state().find("No display") != std::string::npos; }));
  EXPECT_THAT(farm.views(), IsEmpty()) << "nobody looks";
  auto first = std::make_unique<FakeDisplay>(tour.address());
  ASSERT_TRUE(first->wait_for_frames(1));
  FakeDisplay second(tour.address(), fake_wall(640));
  ASSERT_TRUE(second.wait_until(
      [](const auto& d) { return d.frames_complete() > 0 && d.frames().back().view.panorama().width_px() > 640; }));
  first.reset();
  EXPECT_TRUE(tour.eventually([&] { return tour.gauge("displays") == 1; }));
  std::size_t before = 0;
  second.wait_until([&](const auto& d) {
    before = d.frames_complete();
    return true;
  });
  EXPECT_TRUE(second.wait_for_frames(before + 1));
  second.leave();
  EXPECT_THAT(second.wrongs(), IsEmpty());
}

TEST(Tour, sends_no_presentation_time_to_a_single_display_and_the_same_to_several) {
  FakeFarm farm;
  TourProcess tour(settings_for(farm));
  auto first = std::make_unique<FakeDisplay>(tour.address());
  const auto turn = [&](FakeDisplay& display, const std::function<bool(const FakeDisplay&)>& until) {
    for (int i = 0; i < 200; ++i) {
      EXPECT_TRUE(tour.steer(0, 0, 1).ok());
      if (display.wait_until(until, 50ms)) return true;
    }
    return false;
  };
  ASSERT_TRUE(turn(*first, [](const auto& d) { return d.frames_complete() > 5 && d.headings().size() > 5; }));
  ASSERT_TRUE(first->wait_until([](const auto& d) {
    return d.headings_with_show_at() == 0 &&
           std::ranges::none_of(d.frames(), [](const auto& frame) { return frame.show_at.has_value(); });
  }));
  EXPECT_EQ(tour.gauge("frame_lead_ms"), 0.0);

  FakeDisplay second(tour.address());
  wire::ClockRequest question;
  question.set_frame_need_s(0.030);
  question.set_synchronised_share(0.75);
  second.ask(question);
  first->ask(question);
  ASSERT_TRUE(turn(second, [](const auto& d) { return d.frames_complete() > 5 && d.headings_with_show_at() > 5; }));
  EXPECT_TRUE(tour.eventually([&] { return tour.gauge("frame_lead_ms") == 32.0; }));
  EXPECT_TRUE(tour.eventually([&] { return tour.gauge("synchronised_percent") == 75.0; }));
  EXPECT_THAT(tour.status().state(), HasSubstr("The displays are synchronised (75.00 %)"));
  EXPECT_EQ(tour.status().tables(0).rows_size(), 2);
  first->leave();
  second.leave();
  int compared = 0;
  for (const FakeDisplay::Frame& frame : second.frames()) {
    const auto same = std::ranges::find_if(
        first->frames(), [&](const auto& other) { return other.view.number() == frame.view.number(); });
    if (!frame.complete || same == first->frames().end() || !same->complete) continue;
    ASSERT_TRUE(frame.show_at && same->show_at);
    EXPECT_EQ(frame.show_at->refresh(), same->show_at->refresh());
    EXPECT_GT(frame.show_at->refresh() * frame.show_at->period_ns(), frame.show_at->told_ns());
    ++compared;
  }
  EXPECT_GT(compared, 3);
}

TEST(Tour, answers_requests_for_the_time) {
  FakeFarm farm;
  TourProcess tour(settings_for(farm));
  FakeDisplay display(tour.address());
  wire::ClockRequest question;
  question.set_asked_ns(-4);
  const TimePoint before = SteadyClock().now();
  display.ask(question);
  ASSERT_TRUE(display.wait_until([](const auto& d) { return !d.answers().empty(); }));
  display.leave();
  const wire::ClockReply& answer = display.answers()[0];
  EXPECT_EQ(answer.asked_ns(), -4);
  EXPECT_GE(answer.received_ns(), to_nanoseconds(before));
  EXPECT_GE(answer.answered_ns(), answer.received_ns());
  EXPECT_LE(answer.answered_ns(), to_nanoseconds(SteadyClock().now()));
  EXPECT_NEAR(static_cast<double>(answer.system_ns()),
              static_cast<double>(std::chrono::system_clock::now().time_since_epoch().count()), 60e9);
}

TEST(Tour, never_lets_a_slow_display_hold_up_the_others) {
  FakeFarm farm;
  TourSettings settings = settings_for(farm);
  settings.picture.jpeg_quality = 100;
  TourProcess tour(std::move(settings));
  const Panorama large{4096, 2048, 2.0, 0.5, -0.5};  // Large enough that frames soon exceed gRPC's own buffers.
  FakeDisplay quick(tour.address(), large);
  FakeDisplay slow(tour.address(), large, false);
  ASSERT_TRUE(slow.wait_for_frames(1));
  slow.set_reading(false);
  for (int i = 0; i < 40 && !(tour.gauge("dropped: a display was too slow to take it") > 0); ++i) {
    std::size_t before = 0;
    quick.wait_until([&](const auto& d) {
      before = d.frames_complete();
      return true;
    });
    ASSERT_TRUE(tour.steer(0, 0, 1).ok());
    ASSERT_TRUE(quick.wait_for_frames(before + 1)) << "held up";
  }
  EXPECT_GT(tour.gauge("dropped: a display was too slow to take it"), 0);
  slow.set_reading(true);
  std::uint64_t newest = 0;
  quick.wait_until([&](const auto& d) {
    newest = d.frames().back().view.number();
    return true;
  });
  EXPECT_TRUE(slow.wait_until(
      [&](const auto& d) { return d.frames_complete() > 1 && d.frames().back().view.number() >= newest; }));
  slow.leave();
  quick.leave();
  EXPECT_THAT(slow.wrongs(), IsEmpty());
  EXPECT_THAT(quick.wrongs(), IsEmpty());
}

TEST(Tour, refuses_a_display_without_a_hello_or_with_an_invalid_one) {
  FakeFarm farm;
  TourProcess tour(settings_for(farm));
  FakeDisplay nonsense(tour.address(), Panorama{100, 100, -1.0, 0.5, -0.5});
  ASSERT_TRUE(nonsense.wait_until([](const auto& d) { return d.is_over(); }));
  EXPECT_EQ(nonsense.status().error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  auto channel = make_channel(tour.address());
  ASSERT_TRUE(channel);
  grpc::ClientContext context;
  const auto stub = wire::Tour::NewStub(*channel);
  const auto stream = stub->Show(&context);
  wire::DisplayReport report;
  report.mutable_presented()->set_view_number(1);
  stream->Write(report);
  wire::ShowMessage message;
  EXPECT_FALSE(stream->Read(&message));
  EXPECT_EQ(stream->Finish().error_code(), grpc::StatusCode::INVALID_ARGUMENT);
}

TEST(Tour, ignores_invalid_poses_without_a_jump) {
  FakeFarm farm;
  TourProcess tour(settings_for(farm));
  FakeDisplay display(tour.address());
  ASSERT_TRUE(display.wait_for_frames(1));
  FakeTracker tracker(tour.address());
  wire::TrackedPose pose = tracker.picture();
  pose.set_found(true);
  pose.set_rotation_w(std::numeric_limits<double>::quiet_NaN());
  ASSERT_TRUE(tracker.send(pose));
  pose.set_sequence(99);
  pose.set_rotation_w(0);
  ASSERT_TRUE(tracker.send(pose));
  pose.set_sequence(100);
  pose.set_rotation_w(1);
  pose.mutable_position_m()->set_x(std::numeric_limits<double>::infinity());
  ASSERT_TRUE(tracker.send(pose));
  ASSERT_TRUE(tour.eventually([&] { return tour.stage_count("pose") >= 3; }));
  ASSERT_TRUE(tour.eventually([&] { return tour.gauge("heading_deg") == 0.0; }));
  EXPECT_EQ(tour.gauge("turn_deg_per_s"), 0.0);
}

TEST(Tour, informs_displays_that_it_stops) {
  FakeFarm farm;
  TourProcess tour(settings_for(farm));
  FakeDisplay display(tour.address());
  ASSERT_TRUE(display.wait_for_frames(1));
  tour.stop();
  ASSERT_TRUE(display.wait_until([](const auto& d) { return d.is_over(); }));
  EXPECT_EQ(display.status().error_code(), grpc::StatusCode::UNAVAILABLE);
}

TEST(Tour, starts_without_a_farm_and_reports_it) {
  TourSettings settings = default_tour_settings();
  settings.coordinators = {"[::1]:1"};
  TourProcess tour(settings);
  FakeDisplay display(tour.address());
  EXPECT_TRUE(display.wait_until([](const auto& d) { return !d.headings().empty(); }));
  EXPECT_TRUE(tour.eventually([&] { return tour.status().state().find("The farm is away") != std::string::npos; }));
  EXPECT_THAT(tour.status().state(), HasSubstr("[::1]:1"));
  EXPECT_FALSE(tour.status().healthy());
}

TEST(Tour, refuses_an_invalid_address) {
  TourSettings settings = default_tour_settings();
  settings.coordinators = {"::1:7401"};
  InspectionService inspection("tour");
  EXPECT_FALSE(Tour::start(settings, &inspection));
}

}  // namespace
}  // namespace cyclorama::tour

// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/trust/view_guard.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

namespace cyclorama::trust {
namespace {

using testing::HasSubstr;

constexpr TimePoint kStart{std::chrono::hours(1)};
constexpr double kEyeHeight = 1.7;

TimePoint at(double seconds) {
  return kStart + std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}

void add_square(double half, google::protobuf::RepeatedPtrField<wire::GroundPoint>* corners) {
  for (const auto& [x, z] : {std::pair(-half, -half), {half, -half}, {half, half}, {-half, half}}) {
    wire::GroundPoint& corner = *corners->Add();
    corner.set_x_m(x);
    corner.set_z_m(z);
  }
}

/// A square of 20 m with a pillar of 2 m in its middle; a stop lies outside.
wire::SceneDescription scene() {
  wire::SceneDescription scene;
  scene.mutable_start_eye_m()->set_x(5.0);
  scene.mutable_start_eye_m()->set_y(kEyeHeight);
  scene.set_walking_scale(1.0);
  add_square(10.0, scene.mutable_walkable());
  add_square(1.0, scene.add_walkable_holes()->mutable_corners());
  wire::TourStop& stop = *scene.add_stops();
  stop.mutable_eye_m()->set_x(-15.0);
  stop.mutable_eye_m()->set_y(4.0);
  return scene;
}

wire::View view(double x, double z, double y = kEyeHeight) {
  wire::View view;
  view.mutable_eye_m()->set_x(x);
  view.mutable_eye_m()->set_y(y);
  view.mutable_eye_m()->set_z(z);
  view.mutable_panorama()->set_width_px(1920);
  view.mutable_panorama()->set_height_px(1080);
  view.mutable_panorama()->set_azimuth_span_rad(2.0);
  return view;
}

std::string refusal(ViewGuard& guard, const wire::View& view, double seconds = 0.0) {
  const Status status = guard.check(view, at(seconds));
  return status ? "" : status.error().message();
}

TEST(ViewGuard, keeps_eyes_in_the_walkable_area_out_of_its_holes_and_at_the_height_of_visitors) {
  const auto alone = [](const wire::View& view) {
    ViewGuard guard(scene());
    return refusal(guard, view);
  };
  EXPECT_EQ(alone(view(9.9, -9.9)), "");
  EXPECT_EQ(alone(view(10.2, 0.0)), "") << "within the margin";
  EXPECT_THAT(alone(view(10.4, 0.0)), HasSubstr("walkable"));
  EXPECT_EQ(alone(view(0.8, 0.0)), "");
  EXPECT_THAT(alone(view(0.0, 0.5)), HasSubstr("walkable")) << "in the pillar";
  EXPECT_EQ(alone(view(-15.0, 0.2)), "") << "a stop";
  EXPECT_EQ(alone(view(5.0, 5.0, 4.9)), "");
  EXPECT_THAT(alone(view(5.0, 5.0, 5.1)), HasSubstr("eye_m.y"));
  EXPECT_THAT(alone(view(5.0, 5.0, 0.6)), HasSubstr("eye_m.y"));
}

TEST(ViewGuard, permits_a_scene_without_an_area) {
  wire::SceneDescription open = scene();
  open.clear_walkable();
  open.clear_walkable_holes();
  ViewGuard guard(open);
  EXPECT_EQ(refusal(guard, view(500.0, 0.0)), "");
}

TEST(ViewGuard, permits_a_walking_pace_and_jumps_to_the_start_and_the_stops_alone) {
  ViewGuard guard(scene());
  double now = 0.0;
  for (int step = 0; step < 900; ++step, now += 0.016) {
    ASSERT_EQ(refusal(guard, view(-9.0 + 0.02 * step, 5.0), now), "") << step;
  }
  EXPECT_EQ(refusal(guard, view(-15.0, 0.0), now), "") << "a stop, from far away";
  EXPECT_EQ(refusal(guard, view(5.0, 0.0), now), "") << "the start";
  EXPECT_EQ(refusal(guard, view(5.0, 3.0), now), "") << "a prediction that ran ahead";
  EXPECT_THAT(refusal(guard, view(5.0, 8.0), now), HasSubstr("faster"));
  ViewGuard quick(scene());
  int refused = 0;
  for (int i = 0; i < 1000; ++i) refused += refusal(quick, view(9.0 * (i % 2), 5.0), 1e-3 * i).empty() ? 0 : 1;
  EXPECT_GT(refused, 990) << "a scan at 1000 views a second";
  EXPECT_EQ(refusal(quick, view(7.0, 5.0), 1e5), "") << "after a rest";
}

TEST(ViewGuard, permits_a_jump_within_the_area_after_a_rest) {
  ViewGuard guard(scene());
  EXPECT_EQ(refusal(guard, view(-9.0, 5.0), 0.0), "");
  EXPECT_EQ(refusal(guard, view(9.0, 5.0), 0.1), "") << "18 m, between two stops of a museum's tour";
  EXPECT_EQ(refusal(guard, view(9.0, 5.0), 0.2), "") << "and stays there";
  EXPECT_THAT(refusal(guard, view(-9.0, 5.0), 1.0), HasSubstr("faster"));
  ViewGuard again(scene());
  for (int jump = 0; jump < 20; ++jump)
    EXPECT_EQ(refusal(again, view(jump % 2 == 0 ? -9.0 : 9.0, 5.0), 2.1 * jump), "") << jump;
}

TEST(ViewGuard, scales_the_pace_with_the_scenes_walking_scale) {
  wire::SceneDescription large = scene();
  large.set_walking_scale(4.0);
  ViewGuard guard(large);
  EXPECT_EQ(refusal(guard, view(-9.0, 5.0)), "");
  EXPECT_EQ(refusal(guard, view(5.0, 5.0)), "");
  EXPECT_THAT(refusal(guard, view(-9.0, 5.0)), HasSubstr("8.0 m/s"));
}

TEST(ViewGuard, refuses_eyes_far_apart_and_telescopes) {
  ViewGuard guard(scene());
  wire::View two = view(5.0, 5.0);
  two.mutable_panorama()->mutable_eyes()->set_distance_m(0.065);
  EXPECT_EQ(refusal(guard, two), "");
  two.mutable_panorama()->mutable_eyes()->set_distance_m(1.5);
  EXPECT_THAT(refusal(guard, two), HasSubstr("distance_m"));
  wire::View fine = view(5.0, 5.0);
  fine.mutable_panorama()->set_azimuth_span_rad(0.05);
  EXPECT_THAT(refusal(guard, fine), HasSubstr("per radian"));
  fine.mutable_panorama()->set_projection(wire::Panorama::PERSPECTIVE);
  fine.mutable_panorama()->set_tan_left(-3.0);
  fine.mutable_panorama()->set_tan_right(3.0);
  EXPECT_EQ(refusal(guard, fine), "") << "a wide wall";
  fine.mutable_panorama()->set_tan_left(2.6);
  EXPECT_THAT(refusal(guard, fine), HasSubstr("per radian")) << "a narrow part of it, far to the side";
  fine.mutable_panorama()->set_projection(wire::Panorama::FISHEYE);
  fine.mutable_panorama()->set_field_rad(3.1);
  EXPECT_EQ(refusal(guard, fine), "");
  fine.mutable_panorama()->set_field_rad(0.03);
  EXPECT_THAT(refusal(guard, fine), HasSubstr("per radian"));
}

TEST(DailyViews, count_views_and_distinct_places_of_each_day) {
  DailyViews day;
  const DailyViews::Limits limits{.views = 5, .places = 2};
  EXPECT_TRUE(day.count("grotto", view(0.1, 0.1), limits, 1));
  EXPECT_TRUE(day.count("grotto", view(0.2, 0.2), limits, 1)) << "the same place";
  EXPECT_TRUE(day.count("relic", view(0.1, 0.1), limits, 1));
  EXPECT_EQ(day.places(), 2);
  const Status third = day.count("grotto", view(-0.1, 0.1), limits, 1);
  ASSERT_FALSE(third);
  EXPECT_THAT(third.error().message(), HasSubstr("2 places"));
  EXPECT_TRUE(day.count("grotto", view(0.1, 0.1), limits, 1));
  EXPECT_THAT(day.count("grotto", view(0.1, 0.1), limits, 1).error().message(), HasSubstr("5 views"));
  EXPECT_TRUE(day.count("grotto", view(-0.1, 0.1), limits, 2)) << "the next day";
  EXPECT_EQ(day.views(), 1);
}

TEST(DailyViews, have_no_limit_of_their_own) {
  DailyViews day;
  for (int i = 0; i < 1000; ++i) ASSERT_TRUE(day.count("grotto", view(i, i), {}, 1));
  EXPECT_EQ(day.views(), 1000);
  EXPECT_EQ(day.places(), 0) << "not counted, so that they take no memory";
}

}  // namespace
}  // namespace cyclorama::trust

// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/visit_log.h"

#include <gtest/gtest.h>

#include <limits>

#include "kiosk/tour/session/display_hub.h"
#include "kiosk/tour/session/site.h"

namespace cyclorama::tour {
namespace {

using namespace std::chrono_literals;

struct Log {
  InspectionService inspection{"tour"};
  VisitLog log{&inspection};
  TimePoint now{100s};

  double gauge(const std::string& name) {
    const wire::ProcessStatus status = inspection.status();
    for (const auto& gauge : status.gauges()) {
      if (gauge.name() == name) return gauge.value();
    }
    return -1.0;
  }
  wire::Stage stage(const std::string& name) {
    const wire::ProcessStatus status = inspection.status();
    for (const auto& stage : status.stages()) {
      if (stage.name() == name) return stage;
    }
    return {};
  }
  void show(std::uint64_t number, std::int64_t shutter_ns, std::int64_t presented_ns) {
    wire::View view;
    view.set_number(number);
    view.set_shutter_ns(shutter_ns);
    log.add_view(view, now, now - 5ms);
    wire::FramePresented presented;
    presented.set_view_number(number);
    presented.set_presented_ns(presented_ns);
    log.add_presented(presented, now);
  }
};

TEST(VisitLog, measures_from_shutter_to_photon_if_both_have_one_clock) {
  Log log;
  log.show(1, 1'000'000'000, 1'080'000'000);
  EXPECT_NEAR(log.stage("shutter_to_photon").p50_ms(), 80.0, 1e-9);
  EXPECT_NEAR(log.stage("steer").p50_ms(), 5.0, 1e-9);
  log.show(2, 0, 5);                          // Steered by keys.
  log.show(3, 9'000'000'000, 8'000'000'000);  // A clock of another machine.
  log.show(4, 1, 3'600'000'000'000);          // A clock of another machine, with the opposite difference.
  log.show(5, std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(log.stage("shutter_to_photon").count(), 1u);
}

TEST(VisitLog, counts_a_frame_once_however_many_displays_show_it) {
  Log log;
  log.show(1, 0, 5);
  wire::FramePresented again;
  again.set_view_number(1);
  log.log.add_presented(again, log.now);
  again.set_view_number(99);  // Never requested.
  log.log.add_presented(again, log.now);
  EXPECT_EQ(log.gauge("frames"), 1.0);
}

TEST(VisitLog, reports_the_rate_of_the_last_seconds) {
  Log log;
  for (std::uint64_t i = 1; i <= 100; ++i) {
    log.show(i, 0, 1);
    log.now += 50ms;
  }
  EXPECT_NEAR(log.log.frames_per_second(log.now), 20.0, 0.5);
  EXPECT_LT(log.log.frames_per_second(log.now + 4s), 10.0);
  EXPECT_EQ(log.log.frames_per_second(log.now + 6s), 0.0);
}

TEST(VisitLog, reports_bytes_balance_and_why_frames_were_dropped) {
  Log log;
  wire::Tile tile;
  tile.set_jpeg(std::string(600, 'j'));
  log.log.add_tile(tile);
  log.log.add_tile(tile);
  wire::FrameEnd end;
  end.set_complete(true);
  end.set_balance_efficiency(0.9);
  end.set_nodes(3);
  log.log.add_end(end, log.now);
  log.log.add_tile(tile);
  end.set_complete(false);
  end.set_reason("a node was lost");
  log.log.add_end(end, log.now);
  EXPECT_EQ(log.gauge("bytes_per_frame"), 1200.0) << "of complete frames";
  EXPECT_EQ(log.gauge("balance_efficiency"), 0.9);
  EXPECT_EQ(log.gauge("nodes"), 3.0);
  EXPECT_EQ(log.gauge("dropped: a node was lost"), 1.0);
}

TEST(VisitLog, reports_the_size_of_moving_frames_only) {
  Log log;
  wire::View view;
  view.set_number(1);
  view.mutable_panorama()->set_width_px(1000);
  log.log.add_view(view, log.now, std::nullopt);
  view.mutable_panorama()->set_width_px(700);
  log.log.add_begin(view);
  EXPECT_NEAR(log.gauge("picture_scale"), 0.7, 1e-9);
  wire::FrameEnd end;
  end.set_view_number(1);
  end.set_complete(true);
  log.log.add_end(end, log.now);
  view.mutable_panorama()->set_width_px(1000);  // The farm refines it at its full size.
  log.log.add_begin(view);
  EXPECT_NEAR(log.gauge("picture_scale"), 0.7, 1e-9);
}

TEST(VisitLog, distinguishes_a_refined_picture_from_a_new_one) {
  Log log;
  wire::View view;
  view.set_number(1);
  log.log.add_view(view, log.now, std::nullopt);
  wire::FrameEnd end;
  end.set_view_number(1);
  end.set_complete(true);
  end.set_samples(4);
  end.set_reference_samples(64);
  log.log.add_end(end, log.now + 20ms);
  EXPECT_EQ(log.log.refinement(), std::nullopt);
  end.set_samples(8);
  log.log.add_end(end, log.now + 10s);
  EXPECT_EQ(log.log.refinement(), "refining 8 of 64 samples");
  end.set_samples(64);
  log.log.add_end(end, log.now + 20s);
  EXPECT_EQ(log.log.refinement(), "at rest with 64 samples");
  EXPECT_EQ(log.gauge("samples_per_pixel"), 64.0);
  EXPECT_EQ(log.gauge("refined_frames"), 2.0);
  const wire::ProcessStatus status = log.inspection.status();
  for (const wire::Stage& stage : status.stages()) {
    EXPECT_EQ(stage.count(), 1u) << stage.name() << ": of the first frame alone";
  }
  view.set_number(2);
  log.log.add_view(view, log.now, std::nullopt);
  EXPECT_EQ(log.log.refinement(), std::nullopt) << "the visitor walks, whatever becomes of the view";
  end.set_view_number(2);
  end.set_samples(4);
  log.log.add_end(end, log.now + 21s);
  EXPECT_EQ(log.log.refinement(), std::nullopt);
}

TEST(VisitLog, counts_a_dropped_frame_once_whoever_reports_it) {
  Log log;
  wire::View view;
  wire::FrameDropped dropped;
  dropped.set_reason("the farm gave the frame up: a node was lost");
  for (const std::uint64_t number : {1u, 2u}) {
    view.set_number(number);
    log.log.add_view(view, log.now, std::nullopt);
  }
  wire::FrameEnd end;
  end.set_view_number(1);
  end.set_complete(false);
  end.set_reason("a node was lost");
  log.log.add_end(end, log.now);
  dropped.set_view_number(1);  // The display repeats the farm's report.
  log.log.add_not_shown(dropped);
  EXPECT_EQ(log.gauge("dropped: a node was lost"), 1.0);
  EXPECT_EQ(log.gauge("dropped: " + dropped.reason()), -1.0);
  dropped.set_view_number(2);
  dropped.set_reason("a damaged tile");
  log.log.add_not_shown(dropped);
  log.log.add_not_shown(dropped);  // Reported by another display.
  EXPECT_EQ(log.gauge("dropped: a damaged tile"), 1.0);
}

TEST(VisitLog, is_bounded_whatever_names_peers_send) {
  Log log;
  wire::FramePresented presented;
  for (int i = 0; i < 1000; ++i) {
    log.log.add_dropped("reason " + std::to_string(i));
    wire::StageTime* const stage = presented.add_stages();
    stage->set_name("stage\n\xff" + std::to_string(i));
    stage->set_seconds(i % 2 == 0 ? 0.1 : std::numeric_limits<double>::quiet_NaN());
  }
  log.log.add_presented(presented, log.now);
  const wire::ProcessStatus status = log.inspection.status();
  EXPECT_LT(status.gauges_size(), 40);
  EXPECT_LT(status.stages_size(), 60);
  EXPECT_GT(log.gauge("dropped: other"), 900.0);
}

TEST(VisitLog, reports_the_share_of_views_that_nobody_has_seen) {
  Log log;
  log.log.refresh(log.now);
  EXPECT_EQ(log.gauge("wasted_frames_share"), 0.0);
  wire::View view;
  for (std::uint64_t number = 1; number <= 20; ++number) {
    if (number % 4 != 0) {
      log.show(number, 0, 5);
      continue;
    }
    view.set_number(number);
    log.log.add_view(view, log.now, std::nullopt);
  }
  log.log.refresh(log.now);
  EXPECT_NEAR(log.gauge("wasted_frames_share"), 4.0 / 19.0, 1e-12) << "the last one may still come";
  wire::FramePresented late;
  late.set_view_number(4);
  log.log.add_presented(late, log.now);
  log.log.refresh(log.now);
  EXPECT_NEAR(log.gauge("wasted_frames_share"), 3.0 / 19.0, 1e-12) << "a slower display";
  for (std::uint64_t number = 21; number <= 20 + VisitLog::kMaxSent; ++number) log.show(number, 0, 5);
  log.log.refresh(log.now);
  EXPECT_EQ(log.gauge("wasted_frames_share"), 0.0) << "of the last views";
}

class SilentDisplay final : public DisplayLink {
 public:
  void send_heading(const wire::Heading&, const wire::ShowAt*) override {}
  std::optional<std::uint64_t> send(const SharedShowMessage&) override { return std::nullopt; }
  void send_caption(const SharedShowMessage&) override {}
  void close(const Error&) override {}
};

TEST(DisplayHub, requests_one_picture_for_all_and_refuses_a_display_that_it_cannot_serve) {
  DisplayHub hub;
  const auto left = std::make_shared<SilentDisplay>();
  const auto right = std::make_shared<SilentDisplay>();
  const auto dome = std::make_shared<SilentDisplay>();
  EXPECT_FALSE(hub.wanted());
  ASSERT_TRUE(hub.join(left, "left", Projection{Perspective{500, 400, -1.0, 0.2, 0.5, -0.5, 0.1}, {}}));
  ASSERT_TRUE(hub.join(right, "right", Projection{Perspective{500, 400, -0.2, 1.0, 0.5, -0.5, 0.1}, {}}));
  EXPECT_EQ(std::get<Perspective>(hub.wanted()->shape).tan_right, 1.0);
  EXPECT_EQ(std::get<Perspective>(hub.wanted()->shape).tan_left, -1.0);
  const Status refused = hub.join(dome, "dome", Projection{Fisheye{512, 512}, {}});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code(), ErrorCode::kInvalidArgument);
  EXPECT_NE(refused.error().message().find("'left' is here for a wall of another kind"), std::string::npos);
  hub.leave(left.get());
  hub.leave(right.get());
  EXPECT_TRUE(hub.join(dome, "dome", Projection{Fisheye{512, 512}, {}}));
}

TEST(DisplayHub, requests_both_eyes_only_if_all_displays_show_the_same_two) {
  DisplayHub hub;
  const auto first = std::make_shared<SilentDisplay>();
  const auto second = std::make_shared<SilentDisplay>();
  const Panorama panorama{640, 320, 2.0, 0.5, -0.5};
  Projection two{panorama, {}};
  two.viewing = {Eyes::kOverUnder, 0.063, 3.0};
  ASSERT_TRUE(hub.join(first, "first", two));
  Projection narrower = two;
  narrower.viewing.eye_distance_m = 0.06;
  for (const Projection& other : {Projection{panorama, {}}, narrower}) {
    const Status refused = hub.join(second, "second", other);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code(), ErrorCode::kInvalidArgument);
    EXPECT_NE(refused.error().message().find("'first' is here for other eyes"), std::string::npos);
  }
  EXPECT_TRUE(hub.join(second, "second", two));
  EXPECT_EQ(*hub.wanted(), two);
}

TEST(Site, moves_start_and_stops_inside_and_reports_that_nobody_can_walk) {
  wire::SceneDescription scene;
  scene.set_walking_scale(1.0);
  for (const auto& [x, z] : {std::pair{0.0, 0.0}, {4.0, 0.0}, {4.0, 4.0}, {0.0, 4.0}}) {
    scene.add_walkable()->set_x_m(x);
    scene.mutable_walkable(scene.walkable_size() - 1)->set_z_m(z);
  }
  scene.mutable_start_eye_m()->set_x(50.0);
  scene.add_stops()->mutable_eye_m()->set_z(-9.0);
  std::string warning;
  const Site site = site_of(scene, &warning);
  EXPECT_EQ(warning, "");
  EXPECT_TRUE(site.area->allows(site.start.position_m));
  EXPECT_TRUE(site.area->allows(site.stops.front().position_m));
  scene.clear_walkable();
  EXPECT_EQ(site_of(scene, &warning).area, nullptr);
  EXPECT_NE(warning.find("scene.toml"), std::string::npos);
}

}  // namespace
}  // namespace cyclorama::tour

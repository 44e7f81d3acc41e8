// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/session_admission.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/doubles/fake_clock.h"
#include "tests/doubles/recording_delegate.h"

namespace cyclorama::coordinator {
namespace {

using testing::HasSubstr;

class SessionAdmissionTest : public testing::Test {
 protected:
  SessionAdmissionTest() {
    view.set_number(1);
    view.set_samples(4);
    view.set_jpeg_quality(80);
    view.mutable_panorama()->set_width_px(1024);
    view.mutable_panorama()->set_height_px(512);
    view.mutable_panorama()->set_azimuth_span_rad(2.0);
    view.mutable_panorama()->set_tan_elevation_top(0.5);
    view.mutable_panorama()->set_tan_elevation_bottom(-0.5);
    session.museum = "hall-3";
  }
  std::string refusal() {
    const Status checked = admission.check_view(session, view);
    return checked ? "" : checked.error().message();
  }
  void add_scene(const std::string& name, std::uint64_t bytes) {
    const NodeId id{nodes.size() + 1};
    nodes.add(id, clock.now());
    nodes.at(id).scenes[name] = {.state = Node::SceneState::kLoaded, .memory_bytes = bytes};
  }

  FakeClock clock;
  RecordingDelegate delegate;
  NodeTable nodes;
  SessionTable sessions{clock, delegate};
  const SessionAdmission admission{1 << 20, nodes, sessions};
  Session session;
  wire::View view;
};

TEST_F(SessionAdmissionTest, refuses_views_beyond_the_farm_or_the_grant) {
  EXPECT_EQ(refusal(), "");
  view.mutable_panorama()->set_height_px(1040);
  EXPECT_THAT(refusal(), HasSubstr("renders at most 1048576"));
  view.mutable_panorama()->set_height_px(1024);
  EXPECT_EQ(refusal(), "") << "exactly the largest";
  session.grant.samples = 3;
  EXPECT_THAT(refusal(), HasSubstr("view.samples is 4; this museum's grant allows at most 3"));
  session.grant.samples = 4;
  session.grant.bounces = 2;
  view.set_bounces(3);
  EXPECT_THAT(refusal(), HasSubstr("view.bounces is 3"));
}

TEST_F(SessionAdmissionTest, refuses_views_that_only_the_farm_makes_and_numbers_that_do_not_increase) {
  session.newest_view = 1;
  EXPECT_THAT(refusal(), HasSubstr("must increase"));
  view.set_number(2);
  EXPECT_EQ(refusal(), "");
  view.set_first_sample(4);
  EXPECT_FALSE(refusal().empty());
  view.set_first_sample(0);
  view.set_stored_light(true);
  view.set_samples(64);
  EXPECT_EQ(refusal(), "");
  view.set_samples(65);
  EXPECT_THAT(refusal(), HasSubstr("with stored light it is at most 64"));
}

TEST_F(SessionAdmissionTest, limits_the_work_of_a_cell_that_cannot_be_interrupted) {
  view.set_samples(64);
  view.set_bounces(7);
  view.set_adaptive_error(0.01f);
  EXPECT_EQ(refusal(), "") << "exactly the most";
  view.set_bounces(8);
  EXPECT_THAT(refusal(), HasSubstr("is 576; with adaptive sampling it is at most 512"));
  view.set_samples(4096);
  view.set_bounces(64);
  EXPECT_THAT(refusal(), HasSubstr("is 266240; with adaptive sampling"));
  view.set_adaptive_error(0.0f);
  EXPECT_EQ(refusal(), "") << "its samples are rendered piece by piece";
}

TEST_F(SessionAdmissionTest, limits_frame_budgets_and_references) {
  wire::OpenSession open;
  const auto samples = [&] { return SessionAdmission::reference_samples(session, open); };
  EXPECT_EQ(*samples(), 0) << "it has no budget";
  open.set_frame_budget_ms(60'000.0);
  EXPECT_EQ(*samples(), 1024);
  open.set_reference_samples(4096);
  session.grant.samples = 100;
  EXPECT_EQ(*samples(), 100);
  open.set_reference_samples(4097);
  EXPECT_THAT(samples().error().message(), HasSubstr("must be at most 4096"));
  open.set_reference_samples(1);
  for (const double ms : {-1.0, 60'001.0, std::numeric_limits<double>::quiet_NaN()}) {
    open.set_frame_budget_ms(ms);
    EXPECT_THAT(samples().error().message(), HasSubstr("must be 0 to 60000")) << ms;
  }
}

TEST_F(SessionAdmissionTest, counts_each_scene_of_a_museum_once) {
  add_scene("cave", 600);
  add_scene("hall", 500);
  session.account = AccountId{1};
  session.grant.scene_bytes = 1000.0;
  for (const std::uint64_t id : {1u, 2u}) {
    Session open;
    open.account = AccountId{1};
    open.scene = "cave";
    sessions.add(SessionId{id}, std::move(open));
  }
  EXPECT_TRUE(admission.check_scene_memory(session, "cave"));
  const Status both = admission.check_scene_memory(session, "hall");
  ASSERT_FALSE(both);
  EXPECT_EQ(both.error().code(), ErrorCode::kBusy);
  session.account = AccountId{2};
  EXPECT_TRUE(admission.check_scene_memory(session, "hall")) << "of another museum";
  session.account = AccountId{1};
  session.grant.scene_bytes = 0.0;
  EXPECT_TRUE(admission.check_scene_memory(session, "hall")) << "not limited";
}

}  // namespace
}  // namespace cyclorama::coordinator

// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/trust/gatekeeper.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <utility>

#include "common/base/file.h"
#include "tests/doubles/fake_clock.h"
#include "tests/doubles/fake_scene.h"
#include "tests/support/test_authority.h"

namespace cyclorama::trust {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr const char* kGrants = R"([[museum]]
name = "hall-3"
scenes = ["grotto"]
sessions = 2
[[museum]]
name = "hall-4"
scenes = ["*"]
megabytes_per_s = 1
)";

wire::SceneDescription described(const std::string& name) {
  wire::SceneDescription scene = fake_scene(name);
  scene.clear_walkable();
  for (const auto& [x, z] : {std::pair(-5.0, -5.0), {5.0, -5.0}, {5.0, 5.0}, {-5.0, 5.0}}) {
    wire::GroundPoint& corner = *scene.add_walkable();
    corner.set_x_m(x);
    corner.set_z_m(z);
  }
  return scene;
}

wire::View view_at(double x, double z) {
  wire::View view;
  view.set_number(1);
  view.set_samples(1);
  view.set_jpeg_quality(80);
  view.mutable_eye_m()->set_x(x);
  view.mutable_eye_m()->set_y(described("").start_eye_m().y());
  view.mutable_eye_m()->set_z(z);
  view.mutable_panorama()->set_width_px(256);
  view.mutable_panorama()->set_height_px(128);
  view.mutable_panorama()->set_azimuth_span_rad(2.0);
  view.mutable_panorama()->set_tan_elevation_top(0.5);
  view.mutable_panorama()->set_tan_elevation_bottom(-0.5);
  return view;
}

class GatekeeperTest : public testing::Test {
 protected:
  void open() {
    write(museums(), kGrants);
    TrustOptions options;
    options.tls = authority_.coordinator();
    options.revoked = authority_.revocations();
    options.museums = museums();
    options.audit = authority_.folder() / "audit.jsonl";
    options.max_views_per_second = 100.0;
    auto opened = Gatekeeper::open(options, clock_, [this](const std::string& said) { notices_.push_back(said); });
    ASSERT_TRUE(opened) << opened.error().message();
    gate_ = *std::move(opened);
    clock_.advance(std::chrono::seconds(1));
    EXPECT_THAT(gate_->tick().sessions, IsEmpty());
  }
  static void write(const std::filesystem::path& path, const std::string& text) {
    ASSERT_TRUE(write_file_atomically(path, text));
  }
  Identity museum(const std::string& name) {
    Identity who = *check(authority_.museum(name));
    who.address = "ipv6:[::1]:1234";
    return who;
  }
  Gatekeeper::Leavers tick() {
    clock_.advance(std::chrono::seconds(1));
    return gate_->tick();
  }
  [[nodiscard]] std::filesystem::path museums() const { return authority_.folder() / "museums.toml"; }
  [[nodiscard]] std::string audit() const { return *read_text_file(authority_.folder() / "audit.jsonl", 1 << 20); }
  static std::vector<std::uint64_t> ids(const std::vector<Gatekeeper::Leaver>& leavers) {
    std::vector<std::uint64_t> ids;
    for (const auto& leaver : leavers) ids.push_back(leaver.id);
    return ids;
  }

  TestAuthority authority_;
  FakeClock clock_;
  std::vector<std::string> notices_;
  std::unique_ptr<Gatekeeper> gate_;
};

TEST_F(GatekeeperTest, requires_the_role_of_each_port) {
  open();
  const Identity hall = museum("hall-3");
  EXPECT_FALSE(gate_->refusal(hall, Role::kMuseum));
  EXPECT_THAT(*gate_->refusal(hall, Role::kNode), HasSubstr("certificates of a node"));
  EXPECT_THAT(audit(), AllOf(HasSubstr("museum refused"), HasSubstr(hall.serial)));
}

TEST_F(GatekeeperTest, applies_a_museums_grant) {
  open();
  EXPECT_EQ(gate_->session_connected(1, museum("hall-3"))->scenes, std::vector<std::string>{"grotto"});
  EXPECT_TRUE(gate_->session_connected(2, museum("hall-3")));
  EXPECT_EQ(gate_->session_connected(3, museum("hall-3")).error().code(), ErrorCode::kBusy);
  EXPECT_TRUE(gate_->session_connected(4, museum("hall-4")));
  gate_->session_ended(1, "");
  EXPECT_TRUE(gate_->session_connected(5, museum("hall-3")));
  EXPECT_EQ(gate_->session_connected(6, museum("unlisted")).error().code(), ErrorCode::kNotFound);
  EXPECT_FALSE(gate_->grant_of(museum("unlisted")).allows("grotto"));
}

TEST_F(GatekeeperTest, disconnects_revoked_peers) {
  open();
  const Identity hall = museum("hall-3");
  const Identity node = *check(authority_.node("n1"));
  ASSERT_TRUE(gate_->session_connected(1, hall));
  ASSERT_TRUE(gate_->session_connected(2, museum("hall-4")));
  gate_->node_connected(7, node);
  authority_.run("revoke hall-3");
  authority_.run("revoke n1");
  const auto leavers = tick();
  EXPECT_THAT(ids(leavers.sessions), ElementsAre(1));
  EXPECT_THAT(ids(leavers.nodes), ElementsAre(7));
  EXPECT_THAT(*gate_->refusal(hall, Role::kMuseum), HasSubstr("revoked"));
  EXPECT_FALSE(gate_->refusal(museum("hall-4"), Role::kMuseum));
}

TEST_F(GatekeeperTest, disconnects_peers_that_lost_their_scene) {
  open();
  ASSERT_TRUE(gate_->session_connected(1, museum("hall-3")));
  gate_->session_opened(1, described("grotto"));
  ASSERT_TRUE(gate_->session_connected(2, museum("hall-4")));
  write(museums(), "[[museum]]\nname = \"hall-3\"\nscenes = [\"relic\"]\n");
  const auto leavers = tick();
  EXPECT_THAT(ids(leavers.sessions), ElementsAre(1, 2));
  EXPECT_THAT(leavers.sessions[0].reason, HasSubstr("'grotto' is not granted"));
  EXPECT_TRUE(gate_->grant_of(museum("hall-3")).allows("relic"));
}

TEST_F(GatekeeperTest, keeps_the_last_valid_files_and_reports_it_once) {
  open();
  authority_.run("revoke hall-4");
  EXPECT_THAT(tick().sessions, IsEmpty());
  ASSERT_TRUE(gate_->refusal(museum("hall-3"), Role::kMuseum) == std::nullopt);
  notices_.clear();
  write(museums(), "[[museum]]\nname = 3\n");
  write(authority_.revocations(), "what?");
  EXPECT_THAT(tick().sessions, IsEmpty());
  EXPECT_THAT(notices_, ElementsAre(HasSubstr("museums.toml:"), HasSubstr("crl.pem")));
  EXPECT_THAT(tick().sessions, IsEmpty());
  std::filesystem::remove(authority_.revocations());
  tick();
  tick();
  EXPECT_EQ(notices_.size(), 3u) << "the list is missing now";
  EXPECT_TRUE(gate_->grant_of(museum("hall-3")).allows("grotto"));
  TestAuthority other;
  write(authority_.revocations(), *read_text_file(other.revocations(), 1 << 20));
  tick();
  EXPECT_THAT(notices_.back(), HasSubstr("was not signed by the farm's authority"));
}

TEST_F(GatekeeperTest, keeps_revocations_when_the_list_is_gone) {
  open();
  const Identity hall = museum("hall-3");
  authority_.run("revoke hall-3");
  tick();
  std::filesystem::remove(authority_.revocations());
  tick();
  EXPECT_TRUE(gate_->refusal(hall, Role::kMuseum));
}

TEST_F(GatekeeperTest, ends_a_flood_of_views) {
  open();
  ASSERT_TRUE(gate_->session_connected(1, museum("hall-3")));
  int borne = 0;
  while (borne < 5000 && gate_->view_received(1, view_at(0.0, 0.0))) ++borne;
  EXPECT_EQ(borne, 1000);
  clock_.advance(std::chrono::seconds(2));
  for (int i = 0; i < 190; ++i) EXPECT_TRUE(gate_->view_received(1, view_at(0.0, 0.0)));
}

TEST_F(GatekeeperTest, limits_a_museums_bytes_per_second) {
  open();
  ASSERT_TRUE(gate_->session_connected(1, museum("hall-3")));
  ASSERT_TRUE(gate_->session_connected(2, museum("hall-4")));
  wire::SessionReply tile;
  tile.mutable_tile()->set_jpeg(std::string(900'000, 'x'));
  tile.mutable_tile()->set_depth(std::string(100'000, 'x'));
  wire::SessionReply end;
  end.mutable_end()->set_complete(true);
  for (int frame = 0; frame < 4; ++frame) {
    EXPECT_EQ(gate_->reply_written(1, tile), clock_.now());
    EXPECT_EQ(gate_->reply_written(1, end), clock_.now()) << "it has no limit";
    gate_->reply_written(2, tile);
    EXPECT_NEAR(to_seconds(gate_->reply_written(2, end) - clock_.now()), frame, 1e-6)
        << "the first second is a reserve";
  }
}

TEST_F(GatekeeperTest, logs_one_line_per_connection_and_disconnection) {
  open();
  const Identity hall = museum("hall-3");
  ASSERT_TRUE(gate_->session_connected(1, hall));
  gate_->session_opened(1, described("grotto"));
  wire::SessionReply reply;
  reply.mutable_tile()->set_jpeg("0123456789");
  gate_->reply_written(1, reply);
  reply.mutable_end()->set_complete(true);
  gate_->reply_written(1, reply);
  clock_.advance(std::chrono::milliseconds(2500));
  gate_->session_ended(1, "it was \"long\"\n");
  gate_->session_ended(1, "again");
  EXPECT_THAT(audit(), HasSubstr("\"event\":\"session opened\",\"role\":\"museum\",\"name\":\"hall-3\",\"serial\":\"" +
                                 hall.serial + "\",\"address\":\"ipv6:[::1]:1234\",\"scene\":\"grotto\"}\n"));
  EXPECT_THAT(audit(), HasSubstr("\"reason\":\"it was \\\"long\\\"?\",\"seconds\":2.5,\"frames\":1,\"bytes\":10}\n"));
  EXPECT_THAT(audit(), Not(HasSubstr("again")));
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(gate_->session_connected(2, museum("unlisted")).has_value());
  const std::string log = audit();
  EXPECT_EQ(log.find("session refused"), log.rfind("session refused")) << "once a minute";
}

TEST_F(GatekeeperTest, starts_a_new_log_when_the_old_one_was_renamed) {
  open();
  std::filesystem::rename(authority_.folder() / "audit.jsonl", authority_.folder() / "audit.jsonl.1");
  gate_->node_connected(1, *check(authority_.node("n1")));
  EXPECT_THAT(audit(), HasSubstr("node came"));
}

TEST_F(GatekeeperTest, requires_valid_files_at_the_start) {
  const auto refusal_of = [&](const TrustOptions& options) {
    const auto opened = Gatekeeper::open(options, clock_, [](const std::string&) {});
    return opened ? "" : opened.error().message();
  };
  EXPECT_EQ(refusal_of({}), "");
  EXPECT_THAT(refusal_of({.museums = museums()}), HasSubstr("need [tls]"));
  EXPECT_THAT(refusal_of({.tls = authority_.coordinator(), .museums = museums()}), HasSubstr("museums.toml"));
  EXPECT_THAT(refusal_of({.tls = authority_.coordinator(), .revoked = "/nowhere/crl.pem"}),
              HasSubstr("/nowhere/crl.pem"));
  EXPECT_THAT(refusal_of({.audit = "/nowhere/audit"}), HasSubstr("/nowhere/audit"));
}

TEST(FullDisk, is_reported_once_and_affects_no_session) {
  FakeClock clock;
  std::vector<std::string> said;
  const auto gate =
      *Gatekeeper::open({.audit = "/dev/full"}, clock, [&](const std::string& sentence) { said.push_back(sentence); });
  for (std::uint64_t id = 1; id <= 3; ++id) {
    EXPECT_TRUE(gate->session_connected(id, {})->allows("grotto"));
    gate->session_opened(id, described("grotto"));
    EXPECT_TRUE(gate->view_received(id, view_at(0.0, 0.0)));
    gate->session_ended(id, "");
    gate->node_connected(id, {});
    clock.advance(std::chrono::seconds(1));
    EXPECT_FALSE(gate->tick().changed);
    gate->node_disconnected(id, "");
  }
  EXPECT_THAT(said, ElementsAre(AllOf(HasSubstr("/dev/full"), HasSubstr("sessions continue without it"))));
}

TEST(Gatekeeper, admits_everybody_without_tls) {
  FakeClock clock;
  const auto gate = *Gatekeeper::open({}, clock, [](const std::string&) {});
  for (std::uint64_t id = 1; id < 100; ++id) EXPECT_TRUE(gate->session_connected(id, {})->allows("grotto"));
}

TEST_F(GatekeeperTest, refuses_a_view_that_no_visitor_could_have_unless_the_grant_frees_the_eye) {
  open();
  const Identity hall = museum("hall-4");
  ASSERT_TRUE(gate_->session_connected(1, hall));
  gate_->session_opened(1, described("grotto"));
  EXPECT_TRUE(gate_->view_received(1, view_at(1.0, 1.0)));
  const Status outside = gate_->view_received(1, view_at(40.0, 0.0));
  ASSERT_FALSE(outside);
  EXPECT_EQ(outside.error().code(), ErrorCode::kInvalidArgument);
  gate_->session_ended(1, outside.error().message());
  EXPECT_THAT(audit(), HasSubstr("outside the walkable area"));
  write(museums(), "[[museum]]\nname = \"hall-4\"\nscenes = [\"*\"]\nfree_eye = true\n");
  tick();
  ASSERT_TRUE(gate_->session_connected(2, hall));
  gate_->session_opened(2, described("grotto"));
  EXPECT_TRUE(gate_->view_received(2, view_at(40.0, 0.0)));
  wire::View broken = view_at(0.0, 0.0);
  broken.mutable_eye_m()->set_x(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(gate_->view_received(2, broken));
}

TEST_F(GatekeeperTest, counts_the_views_of_a_day_over_all_sessions_of_a_museum) {
  open();
  write(museums(), "[[museum]]\nname = \"hall-4\"\nscenes = [\"*\"]\nviews_per_day = 3\n");
  tick();
  const Identity hall = museum("hall-4");
  for (const std::uint64_t id : {1u, 2u}) {
    ASSERT_TRUE(gate_->session_connected(id, hall));
    gate_->session_opened(id, described("grotto"));
  }
  EXPECT_TRUE(gate_->view_received(1, view_at(0.0, 0.0)));
  EXPECT_TRUE(gate_->view_received(2, view_at(0.0, 0.0)));
  EXPECT_TRUE(gate_->view_received(1, view_at(0.0, 0.0)));
  const Status over = gate_->view_received(2, view_at(0.0, 0.0));
  ASSERT_FALSE(over);
  EXPECT_EQ(over.error().code(), ErrorCode::kBusy);
  clock_.advance(std::chrono::hours(24));
  EXPECT_TRUE(gate_->view_received(2, view_at(0.0, 0.0)));
}

}  // namespace
}  // namespace cyclorama::trust

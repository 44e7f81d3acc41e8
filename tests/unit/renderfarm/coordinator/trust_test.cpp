// SPDX-License-Identifier: Apache-2.0
// The coordinator's ports as museums and nodes see them: real gRPC on [::1], with certificates of a test authority.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/file.h"
#include "common/wire/channel.h"
#include "common/wire/farm.grpc.pb.h"
#include "common/wire/nodes.grpc.pb.h"
#include "renderfarm/coordinator/coordinator.h"
#include "tests/support/test_authority.h"

namespace cyclorama::coordinator {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

void set_deadline(grpc::ClientContext& context) {
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(20));
}

/// A node that reports every scene as loaded and renders nothing.
class RawNode {
 public:
  RawNode(int port, const std::optional<TlsFiles>& tls)
      : stub_(wire::Nodes::NewStub(*make_channel("[::1]:" + std::to_string(port), tls))) {
    set_deadline(context_);
    stream_ = stub_->Work(&context_);
    wire::NodeReport report;
    report.mutable_hello()->set_version(CYCLORAMA_VERSION);
    report.mutable_hello()->set_threads(1);
    stream_->Write(report);
  }
  /// Replies to commands until that many scenes are loaded; returns false if the stream ends before.
  bool load(int scenes) {
    wire::NodeCommand command;
    for (int loaded = 0; loaded < scenes; ++loaded) {
      if (!stream_->Read(&command)) return false;
      wire::NodeReport report;
      wire::SceneLoaded* const scene = report.mutable_scene_loaded();
      scene->set_scene(command.load_scene().scene());
      wire::SceneDescription* const description = scene->mutable_description();
      description->set_name(command.load_scene().scene());
      description->set_walking_scale(1.0);
      description->set_eye_height_m(1.6);
      for (const auto& [x, z] : {std::pair{-9.0, -9.0}, {9.0, -9.0}, {0.0, 9.0}}) {
        wire::GroundPoint* const point = description->add_walkable();
        point->set_x_m(x);
        point->set_z_m(z);
      }
      description->mutable_start_eye_m()->set_y(1.6);
      if (!stream_->Write(report)) return false;
    }
    return true;
  }
  grpc::Status end() {
    wire::NodeCommand command;
    while (stream_->Read(&command)) {
    }
    return stream_->Finish();
  }

 private:
  grpc::ClientContext context_;
  std::unique_ptr<wire::Nodes::Stub> stub_;
  std::unique_ptr<grpc::ClientReaderWriter<wire::NodeReport, wire::NodeCommand>> stream_;
};

class RawSession {
 public:
  explicit RawSession(const std::shared_ptr<grpc::Channel>& channel) : stub_(wire::Farm::NewStub(channel)) {
    set_deadline(context_);
    stream_ = stub_->Session(&context_);
  }
  RawSession(int port, const std::optional<TlsFiles>& tls)
      : RawSession(*make_channel("[::1]:" + std::to_string(port), tls)) {}
  /// Returns true once the session is open.
  bool open(const std::string& scene) {
    wire::SessionRequest request;
    request.mutable_open()->set_scene(scene);
    wire::SessionReply reply;
    return stream_->Write(request) && stream_->Read(&reply) && reply.has_opened();
  }
  bool write(const wire::SessionRequest& request) { return stream_->Write(request); }
  grpc::Status end() {
    wire::SessionReply reply;
    while (stream_->Read(&reply)) {
    }
    return stream_->Finish();
  }
  grpc::Status close() {
    stream_->WritesDone();
    return end();
  }

 private:
  grpc::ClientContext context_;
  std::unique_ptr<wire::Farm::Stub> stub_;
  std::unique_ptr<grpc::ClientReaderWriter<wire::SessionRequest, wire::SessionReply>> stream_;
};

class TrustTest : public testing::Test {
 protected:
  /// Starts a coordinator with two scenes and a node that has both.
  void start(const std::filesystem::path& audit = "audit.jsonl") {
    grant("[[museum]]\nname = \"hall-3\"\nscenes = [\"grotto\"]\n[[museum]]\nname = \"hall-4\"\nscenes = [\"*\"]\n");
    CoordinatorOptions options;
    options.scenes = {{"grotto", "a"}, {"relic", "b"}};
    options.museums = options.nodes = "[::]:0";
    options.trust.tls = authority_.coordinator();
    options.trust.revoked = authority_.revocations();
    options.trust.museums = museums();
    options.trust.audit = authority_.folder() / audit;
    auto started = Coordinator::start(options, [](const std::string&, const NoticeAbout&) {});
    ASSERT_TRUE(started) << started.error().message();
    coordinator_ = *std::move(started);
    node_ = std::make_unique<RawNode>(coordinator_->node_port(), authority_.node("n1"));
    ASSERT_TRUE(node_->load(2));
    // The scenes count as loaded once a session of the last one opens.
    const TlsFiles any = authority_.museum("hall-4");
    const TimePoint deadline = SteadyClock().now() + std::chrono::seconds(20);
    while (!RawSession(coordinator_->museum_port(), any).open("relic")) ASSERT_LT(SteadyClock().now(), deadline);
  }
  void grant(const std::string& text) { ASSERT_TRUE(write_file_atomically(museums(), text)); }
  [[nodiscard]] std::filesystem::path museums() const { return authority_.folder() / "museums.toml"; }
  [[nodiscard]] std::string audit() const { return *read_text_file(authority_.folder() / "audit.jsonl", 1 << 20); }
  std::vector<std::string> scenes_of(const TlsFiles& tls) {
    const auto stub = wire::Farm::NewStub(*make_channel("[::1]:" + std::to_string(coordinator_->museum_port()), tls));
    grpc::ClientContext context;
    set_deadline(context);
    wire::ListScenesReply reply;
    EXPECT_TRUE(stub->ListScenes(&context, {}, &reply).ok());
    std::vector<std::string> names;
    for (const wire::SceneSummary& scene : reply.scenes()) names.push_back(scene.name());
    return names;
  }
  RawSession session(const TlsFiles& tls) { return {coordinator_->museum_port(), tls}; }

  TestAuthority authority_;
  std::unique_ptr<Coordinator> coordinator_;
  std::unique_ptr<RawNode> node_;
};

TEST_F(TrustTest, offers_a_museum_only_its_granted_scenes) {
  start();
  const TlsFiles tls = authority_.museum("hall-3");
  EXPECT_THAT(scenes_of(tls), ElementsAre("grotto"));
  EXPECT_THAT(scenes_of(authority_.museum("hall-4")), ElementsAre("grotto", "relic"));
  EXPECT_THAT(scenes_of(authority_.museum("unlisted")), IsEmpty());
  EXPECT_TRUE(session(tls).open("grotto"));
  RawSession forbidden = session(tls);
  EXPECT_FALSE(forbidden.open("relic"));
  const grpc::Status hidden = forbidden.end();
  RawSession missing = session(tls);
  EXPECT_FALSE(missing.open("nowhere"));
  const grpc::Status absent = missing.end();
  EXPECT_EQ(hidden.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(absent.error_code(), grpc::StatusCode::NOT_FOUND);
  std::string as_absent = hidden.error_message();
  as_absent.replace(as_absent.find("relic"), 5, "nowhere");
  EXPECT_EQ(as_absent, absent.error_message()) << "nobody learns what else the farm has";
}

TEST_F(TrustTest, opens_sessions_while_the_disk_of_the_audit_log_is_full) {
  start("/dev/full");
  RawSession open = session(authority_.museum("hall-3"));
  EXPECT_TRUE(open.open("grotto"));
  EXPECT_TRUE(open.close().ok());
}

TEST_F(TrustTest, keeps_museums_and_nodes_at_their_own_ports) {
  start();
  RawSession as_museum(coordinator_->museum_port(), authority_.node("n2"));
  EXPECT_FALSE(as_museum.open("grotto"));
  EXPECT_EQ(as_museum.end().error_code(), grpc::StatusCode::PERMISSION_DENIED);
  RawNode as_node(coordinator_->node_port(), authority_.museum("hall-3"));
  EXPECT_EQ(as_node.end().error_code(), grpc::StatusCode::PERMISSION_DENIED);
  const auto stub = wire::Nodes::NewStub(
      *make_channel("[::1]:" + std::to_string(coordinator_->node_port()), authority_.museum("hall-3")));
  grpc::ClientContext context;
  set_deadline(context);
  wire::SceneFiles files;
  EXPECT_EQ(stub->ListFiles(&context, {}, &files).error_code(), grpc::StatusCode::PERMISSION_DENIED)
      << "every call of a port is asked about";
}

TEST_F(TrustTest, admits_nobody_without_a_certificate_of_its_authority) {
  start();
  RawSession plain(coordinator_->museum_port(), std::nullopt);
  EXPECT_FALSE(plain.open("grotto"));
  TestAuthority other;
  RawSession foreign = session(other.museum("hall-3"));
  EXPECT_FALSE(foreign.open("grotto"));
  EXPECT_EQ(foreign.end().error_code(), grpc::StatusCode::UNAVAILABLE);
}

TEST_F(TrustTest, ends_open_streams_when_a_certificate_is_revoked) {
  start();
  const TlsFiles tls = authority_.museum("hall-3");
  RawSession open = session(tls);
  ASSERT_TRUE(open.open("grotto"));
  RawSession other = session(authority_.museum("hall-4"));
  ASSERT_TRUE(other.open("grotto"));
  authority_.run("revoke hall-3");
  const grpc::Status ended = open.end();
  EXPECT_EQ(ended.error_code(), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_THAT(ended.error_message(), HasSubstr("revoked"));
  RawSession again = session(tls);
  EXPECT_FALSE(again.open("grotto"));
  EXPECT_THAT(again.end().error_message(), HasSubstr("revoked"));
  EXPECT_TRUE(other.close().ok()) << "others go on";
  authority_.run("revoke n1");
  EXPECT_EQ(node_->end().error_code(), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_TRUE(session(authority_.museum("hall-3")).end().error_message().find("revoked") == std::string::npos)
      << "a new certificate is welcome";
}

TEST_F(TrustTest, ends_a_session_whose_grant_is_withdrawn) {
  start();
  RawSession open = session(authority_.museum("hall-3"));
  ASSERT_TRUE(open.open("grotto"));
  grant("[[museum]]\nname = \"hall-3\"\nscenes = [\"relic\"]\n");
  const grpc::Status ended = open.end();
  EXPECT_EQ(ended.error_code(), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_THAT(ended.error_message(), HasSubstr("'grotto' is not granted any more"));
  EXPECT_THAT(scenes_of(authority_.museum("hall-3")), ElementsAre("relic"));
}

TEST_F(TrustTest, ends_a_flood_of_messages_and_an_impossible_message) {
  start();
  const TlsFiles tls = authority_.museum("hall-3");
  RawSession large = session(tls);
  wire::SessionRequest request;
  request.mutable_open()->set_scene(std::string(65 << 10, 'x'));
  large.write(request);
  EXPECT_EQ(large.end().error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  RawSession flood = session(tls);
  ASSERT_TRUE(flood.open("grotto"));
  wire::SessionRequest request_view;
  wire::View& view = *request_view.mutable_view();
  view.set_samples(1);
  view.set_jpeg_quality(85);
  view.mutable_eye_m()->set_y(1.6);
  view.mutable_panorama()->set_width_px(64);
  view.mutable_panorama()->set_height_px(64);
  view.mutable_panorama()->set_azimuth_span_rad(1.0);
  view.mutable_panorama()->set_tan_elevation_top(0.5);
  view.mutable_panorama()->set_tan_elevation_bottom(-0.5);
  for (std::uint64_t number = 1; number <= 100'000; ++number) {
    view.set_number(number);
    if (!flood.write(request_view)) break;
  }
  EXPECT_THAT(flood.end().error_message(), HasSubstr("views per second"));
}

TEST_F(TrustTest, serves_others_while_a_museum_opens_a_thousand_sessions) {
  start();
  const auto channel =
      *make_channel("[::1]:" + std::to_string(coordinator_->museum_port()), authority_.museum("hall-3"));
  std::vector<std::unique_ptr<RawSession>> many;
  for (int i = 0; i < 1000; ++i) many.push_back(std::make_unique<RawSession>(channel));
  RawSession other = session(authority_.museum("hall-4"));
  EXPECT_TRUE(other.open("grotto"));
  EXPECT_TRUE(other.close().ok());
}

TEST_F(TrustTest, logs_who_connected_and_how_it_ended) {
  start();
  {
    RawSession seen = session(authority_.museum("hall-3"));
    ASSERT_TRUE(seen.open("grotto"));
    EXPECT_TRUE(seen.close().ok());
  }
  coordinator_.reset();
  const std::string log = audit();
  for (const char* const part :
       {"\"event\":\"grants read\"", "\"event\":\"node came\",\"role\":\"node\",\"name\":\"n1\"",
        "\"event\":\"session opened\",\"role\":\"museum\",\"name\":\"hall-3\"", "\"event\":\"session ended\"",
        "\"event\":\"node gone\""}) {
    EXPECT_THAT(log, HasSubstr(part));
  }
}

}  // namespace
}  // namespace cyclorama::coordinator

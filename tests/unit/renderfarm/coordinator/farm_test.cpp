// SPDX-License-Identifier: Apache-2.0
// Coordinator, nodes and clients together, over real gRPC on [::1], with a renderer that draws a pattern.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/image/inverse_depth.h"
#include "common/image/jpeg.h"
#include "common/wire/channel.h"
#include "common/wire/farm.grpc.pb.h"
#include "common/wire/inspection.grpc.pb.h"
#include "common/wire/nodes.grpc.pb.h"
#include "renderfarm/client/farm_client.h"
#include "renderfarm/coordinator/coordinator.h"
#include "renderfarm/node/farm_node.h"
#include "tests/doubles/fake_block_renderer.h"
#include "tests/doubles/recording_farm_listener.h"

namespace cyclorama::coordinator {
namespace {

using testing::HasSubstr;

wire::View view_of(std::uint64_t number, std::uint32_t width = 1200, std::uint32_t height = 500) {
  wire::View view;
  view.set_number(number);
  view.set_samples(1);
  view.set_jpeg_quality(95);
  view.mutable_eye_m()->set_y(1.6);
  view.set_heading_rad(0.1);
  view.mutable_panorama()->set_width_px(width);
  view.mutable_panorama()->set_height_px(height);
  view.mutable_panorama()->set_azimuth_span_rad(2.0);
  view.mutable_panorama()->set_tan_elevation_top(0.5);
  view.mutable_panorama()->set_tan_elevation_bottom(-0.5);
  return view;
}

/// Returns the frame as a display would show it; fails if a pixel comes twice or never.
RgbImage composed(const RecordingFarmListener::Frame& frame) {
  const auto& p = frame.view.panorama();
  RgbImage picture(static_cast<int>(p.width_px()), static_cast<int>(p.height_px()));
  GreyImage hits(picture.width(), picture.height());
  JpegDecoder decoder;
  for (const wire::Tile& tile : frame.tiles) {
    EXPECT_EQ(tile.view_number(), frame.view.number());
    const auto pixels = decoder.decode(std::as_bytes(std::span(tile.jpeg())), 1 << 20);
    EXPECT_TRUE(pixels && pixels->width() == static_cast<int>(tile.width_px()) &&
                pixels->height() == static_cast<int>(tile.height_px()));
    if (!pixels) continue;
    for (int y = 0; y < pixels->height(); ++y) {
      for (int x = 0; x < pixels->width(); ++x) {
        const int to_x = static_cast<int>(tile.x_px()) + x;
        const int to_y = static_cast<int>(tile.y_px()) + y;
        std::copy_n(pixels->at(x, y), 3, picture.at(to_x, to_y));
        ++*hits.at(to_x, to_y);
      }
    }
  }
  EXPECT_TRUE(std::ranges::all_of(hits.data(), [](auto n) { return n == 1; })) << "frame " << frame.view.number();
  return picture;
}

/// Returns the depth of a frame as a display would use it; nothing unless every tile brings it.
std::optional<InverseDepthImage> composed_depth(const RecordingFarmListener::Frame& frame) {
  const auto& p = frame.view.panorama();
  const PixelRect all = depth_cells({0, 0, static_cast<int>(p.width_px()), static_cast<int>(p.height_px())});
  InverseDepthImage depth(all.width, all.height);
  for (const wire::Tile& tile : frame.tiles) {
    const PixelRect rect{static_cast<int>(tile.x_px()), static_cast<int>(tile.y_px()),
                         static_cast<int>(tile.width_px()), static_cast<int>(tile.height_px())};
    if (!decode_inverse_depth(std::as_bytes(std::span(tile.depth())), depth_cells(rect), &depth)) return std::nullopt;
  }
  return depth;
}

struct TestNode {
  std::shared_ptr<FakeRendering> rendering = std::make_shared<FakeRendering>();
  std::unique_ptr<node::FarmNode> node;
};

/// A farm in one process.
class FarmTest : public testing::Test {
 protected:
  void start_coordinator(int museum_port = 0, int node_port = 0,
                         std::vector<FarmScene> scenes = {{"grotto", "some/path"}}) {
    CoordinatorOptions options;
    options.scenes = std::move(scenes);
    options.museums = "[::1]:" + std::to_string(museum_port);
    options.nodes = "[::1]:" + std::to_string(node_port);
    options.inspect = "[::1]:0";
    options.limits.first_frame = first_frame;
    auto started = Coordinator::start(options, [](const std::string&, const NoticeAbout&) {});
    ASSERT_TRUE(started) << started.error().message();
    coordinator = *std::move(started);
  }
  TestNode add_node(const std::string& name = "node") {
    TestNode made;
    auto started =
        node::FarmNode::start({.coordinators = {"[::1]:" + std::to_string(coordinator->node_port())}, .name = name},
                              fake_loader(made.rendering));
    EXPECT_TRUE(started);
    made.node = *std::move(started);
    return made;
  }
  std::unique_ptr<client::FarmClient> add_client(client::FarmListener& to, const std::string& scene = "",
                                                 double budget_ms = 0.0) {
    auto started = client::FarmClient::start({.coordinators = {"[::1]:" + std::to_string(coordinator->museum_port())},
                                              .scene = scene,
                                              .museum = "test",
                                              .frame_budget_ms = budget_ms,
                                              .reference_samples = kReference},
                                             to);
    EXPECT_TRUE(started);
    return *std::move(started);
  }
  /// Polls the inspection service until `nodes` nodes have the default scene.
  bool wait_for_nodes(std::size_t nodes) {
    const auto channel = make_channel("[::1]:" + std::to_string(coordinator->inspect_port()));
    const auto stub = wire::Inspection::NewStub(*channel);
    const TimePoint deadline = SteadyClock().now() + std::chrono::seconds(20);
    while (SteadyClock().now() < deadline) {
      grpc::ClientContext context;
      wire::ProcessStatus status;
      if (!stub->GetStatus(&context, {}, &status).ok()) continue;
      for (const wire::Gauge& gauge : status.gauges()) {
        if (gauge.name() == "nodes" && gauge.value() == static_cast<double>(nodes) &&
            (nodes == 0 || status.healthy())) {
          return true;
        }
      }
    }
    return false;
  }
  bool wait_for_frames(std::size_t count) {
    return listener.wait([&](const auto& seen) { return seen.frames.size() >= count; });
  }

  bool wait_for_rest() {
    return listener.wait(
        [](const auto& seen) { return !seen.frames.empty() && seen.frames.back().end.samples() == kReference; });
  }

  static constexpr int kReference = 64;
  /// So long that a node which a busy computer stops for a moment does not count as silent.
  Duration first_frame = std::chrono::minutes(1);
  std::unique_ptr<Coordinator> coordinator;
  RecordingFarmListener listener;
};

TEST_F(FarmTest, renders_the_same_picture_with_1_2_3_and_5_nodes) {
  std::vector<RgbImage> pictures;
  for (const std::size_t n : {1u, 2u, 3u, 5u}) {
    start_coordinator();
    std::vector<TestNode> nodes;
    for (std::size_t i = 0; i < n; ++i) nodes.push_back(add_node());
    ASSERT_TRUE(wait_for_nodes(n));
    RecordingFarmListener to;
    const auto client = add_client(to);
    for (std::uint64_t number = 1; number <= 4; ++number) {
      client->request(view_of(number));
      ASSERT_TRUE(to.wait([&](const auto& seen) { return seen.frames.size() == number; }));
    }
    const auto seen = to.seen();
    for (const auto& frame : seen.frames) EXPECT_TRUE(frame.end.complete()) << frame.end.reason();
    EXPECT_EQ(seen.frames.back().end.nodes(), n);
    pictures.push_back(composed(seen.frames.back()));
    for (const char* const stage : {"plan", "render", "encode", "farm"}) {
      EXPECT_TRUE(
          std::ranges::any_of(seen.frames.back().end.stages(), [&](const auto& s) { return s.name() == stage; }));
    }
    client->stop();
    coordinator.reset();
  }
  for (const RgbImage& picture : pictures) EXPECT_EQ(picture, pictures.front());
}

TEST_F(FarmTest, denoises_blocks_if_a_view_requests_it) {
  start_coordinator();
  TestNode node = add_node();
  ASSERT_TRUE(wait_for_nodes(1));
  const auto client = add_client(listener);
  client->request(view_of(1));
  ASSERT_TRUE(wait_for_frames(1));
  const int tiles = node.rendering->renders;
  ASSERT_GT(tiles, 4);
  wire::View again = view_of(1);
  again.set_number(1 + 256);  // The pattern repeats after 256 views.
  again.set_denoise(true);
  client->request(again);
  ASSERT_TRUE(wait_for_frames(2));
  EXPECT_EQ(node.rendering->renders, tiles + 1) << "one render for the only node's block";
  const RgbImage plain = composed(listener.seen().frames[0]);
  const RgbImage negative = composed(listener.seen().frames[1]);
  std::size_t different = 0;
  for (std::size_t i = 0; i < plain.data().size(); ++i) {
    different += std::abs(255 - plain.data()[i] - negative.data()[i]) > 40 ? 1u : 0u;  // Beyond JPEG's error.
  }
  EXPECT_LT(different, plain.data().size() / 50);
}

TEST_F(FarmTest, brings_whole_depth_if_a_view_requests_it) {
  start_coordinator();
  std::vector<TestNode> nodes;
  for (int i = 0; i < 3; ++i) nodes.push_back(add_node());
  ASSERT_TRUE(wait_for_nodes(3));
  const auto client = add_client(listener);
  for (std::uint64_t number = 1; number <= 4; ++number) {
    wire::View view = view_of(number);
    view.set_depth(number % 2 == 0);
    view.set_denoise(number == 4);
    client->request(view);
    ASSERT_TRUE(wait_for_frames(number));
  }
  const auto seen = listener.seen();
  for (const auto& frame : seen.frames) {
    EXPECT_EQ(frame.view.depth(), frame.view.number() % 2 == 0);
    if (frame.view.depth()) {
      EXPECT_EQ(composed_depth(frame), fake_depth({0, 0, 300, 125}));
    } else {
      for (const wire::Tile& tile : frame.tiles) EXPECT_TRUE(tile.depth().empty());
    }
  }
}

TEST_F(FarmTest, brings_no_depth_at_rest) {
  start_coordinator();
  TestNode node = add_node();
  ASSERT_TRUE(wait_for_nodes(1));
  const auto client = add_client(listener, "", 1000.0);
  wire::View view = view_of(1);
  view.set_depth(true);
  client->request(view);
  ASSERT_TRUE(wait_for_rest());
  const auto seen = listener.seen();
  ASSERT_GT(seen.frames.size(), 1u);
  EXPECT_TRUE(composed_depth(seen.frames.front()));
  for (std::size_t i = 1; i < seen.frames.size(); ++i) {
    EXPECT_FALSE(seen.frames[i].view.depth());
    for (const wire::Tile& tile : seen.frames[i].tiles) EXPECT_TRUE(tile.depth().empty());
  }
}

TEST_F(FarmTest, completes_frames_when_a_node_dies_during_one) {
  start_coordinator();
  TestNode steady = add_node("steady");
  TestNode dying = add_node("dying");
  ASSERT_TRUE(wait_for_nodes(2));
  const auto client = add_client(listener);
  dying.rendering->close_gate_after(2);
  client->request(view_of(1));
  ASSERT_TRUE(listener.wait([&](const auto&) { return dying.rendering->renders >= 1; }));
  client->request(view_of(2));
  // The steady node sends its part; the other stops after two tiles and then disconnects.
  ASSERT_TRUE(
      listener.wait([&](const auto&) { return dying.rendering->renders == 2 && steady.rendering->renders >= 2; }));
  dying.node->stop();
  ASSERT_TRUE(wait_for_frames(2));
  const auto seen = listener.seen();
  for (const auto& frame : seen.frames) EXPECT_TRUE(frame.end.complete()) << frame.end.reason();
  EXPECT_EQ(seen.frames[0].view.number(), 1u);
  EXPECT_EQ(seen.frames[1].view.number(), 2u);
  RgbImage first = composed(seen.frames[0]);
  composed(seen.frames[1]);
  client->request(view_of(3));
  ASSERT_TRUE(wait_for_frames(3));
  EXPECT_EQ(listener.seen().frames.back().end.nodes(), 1u);
}

TEST_F(FarmTest, refines_to_the_same_picture_whichever_nodes_render_it) {
  std::vector<RgbImage> pictures;
  for (const std::size_t n : {1u, 2u, 3u}) {
    start_coordinator();
    std::vector<TestNode> nodes;
    for (std::size_t i = 0; i < n; ++i) nodes.push_back(add_node());
    ASSERT_TRUE(wait_for_nodes(n));
    RecordingFarmListener to;
    const auto client = add_client(to, "", 50.0);
    client->request(view_of(1, 600, 300));
    if (n == 3) {
      // One node disconnects during refinement; the others have no samples of its part.
      ASSERT_TRUE(to.wait([](const auto& seen) { return seen.frames.size() >= 3; }));
      nodes.pop_back();
    }
    ASSERT_TRUE(to.wait(
        [](const auto& seen) { return !seen.frames.empty() && seen.frames.back().end.samples() == kReference; }));
    pictures.push_back(composed(to.seen().frames.back()));
    int last = 0;
    for (const auto& frame : to.seen().frames) {
      EXPECT_TRUE(frame.end.complete());
      EXPECT_GT(static_cast<int>(frame.end.samples()), last);
      last = static_cast<int>(frame.end.samples());
    }
    if (n == 1) {
      EXPECT_EQ(nodes[0].rendering->samples % kReference, 0) << "no sample was made twice";
      EXPECT_LE(nodes[0].rendering->samples, 6 * kReference) << "of six tiles";
    }
    client->stop();
    coordinator.reset();
  }
  for (const RgbImage& picture : pictures) EXPECT_EQ(picture, pictures.front());
}

TEST_F(FarmTest, sends_nothing_at_rest_and_starts_again_with_the_next_view) {
  start_coordinator();
  TestNode node = add_node();
  ASSERT_TRUE(wait_for_nodes(1));
  const auto client = add_client(listener, "", 50.0);
  client->request(view_of(1, 320, 160));
  ASSERT_TRUE(wait_for_rest());
  const std::size_t frames = listener.seen().frames.size();
  EXPECT_FALSE(
      listener.wait([&](const auto& seen) { return seen.frames.size() > frames; }, std::chrono::milliseconds(600)));
  wire::View turned = view_of(2, 320, 160);
  turned.set_heading_rad(0.5);
  client->request(turned);
  ASSERT_TRUE(wait_for_frames(frames + 1));
  EXPECT_EQ(listener.seen().frames[frames].view.number(), 2u);
  EXPECT_LT(listener.seen().frames[frames].end.samples(), 64u);
  ASSERT_TRUE(wait_for_rest());
}

TEST_F(FarmTest, replaces_a_node_that_hangs_and_shows_each_tile_once) {
  first_frame = CoordinatorLimits().first_frame;
  start_coordinator();
  TestNode steady = add_node("steady");
  TestNode hanging = add_node("hanging");
  ASSERT_TRUE(wait_for_nodes(2));
  const auto client = add_client(listener);
  hanging.rendering->close_gate_after(1);
  client->request(view_of(1));
  ASSERT_TRUE(wait_for_frames(1));
  EXPECT_TRUE(listener.seen().frames.front().end.complete());
  composed(listener.seen().frames.front());
}

TEST_F(FarmTest, ends_frames_with_a_reason_without_nodes_and_resumes_with_the_next_node) {
  start_coordinator();
  TestNode only = add_node();
  ASSERT_TRUE(wait_for_nodes(1));
  const auto client = add_client(listener);
  only.rendering->close_gate_after(1);
  client->request(view_of(1));
  ASSERT_TRUE(listener.wait([&](const auto&) { return only.rendering->renders == 1; }));
  only.node->stop();
  ASSERT_TRUE(wait_for_frames(1));
  EXPECT_FALSE(listener.seen().frames[0].end.complete());
  EXPECT_THAT(listener.seen().frames[0].end.reason(), HasSubstr("no node is left"));
  client->request(view_of(2));
  ASSERT_TRUE(listener.wait([](const auto& seen) { return !seen.reasons.empty(); }));
  EXPECT_THAT(listener.seen().reasons.front(), HasSubstr("no node is connected"));
  TestNode next = add_node();
  ASSERT_TRUE(wait_for_frames(2));
  EXPECT_TRUE(listener.seen().frames[1].end.complete());
  EXPECT_EQ(listener.seen().frames[1].view.number(), 2u);
}

TEST_F(FarmTest, uses_a_late_node_from_a_later_frame_on) {
  start_coordinator();
  TestNode first = add_node();
  ASSERT_TRUE(wait_for_nodes(1));
  const auto client = add_client(listener);
  client->request(view_of(1));
  ASSERT_TRUE(wait_for_frames(1));
  TestNode second = add_node();
  ASSERT_TRUE(wait_for_nodes(2));
  for (std::uint64_t number = 2;; ++number) {
    ASSERT_LT(number, 1000u);
    client->request(view_of(number));
    ASSERT_TRUE(wait_for_frames(number));
    if (listener.seen().frames.back().end.nodes() == 2) break;
  }
  EXPECT_EQ(composed(listener.seen().frames.back()).width(), 1200);
}

TEST_F(FarmTest, recovers_when_the_coordinator_restarts) {
  start_coordinator();
  TestNode node = add_node();
  ASSERT_TRUE(wait_for_nodes(1));
  const auto client = add_client(listener);
  client->request(view_of(1));
  ASSERT_TRUE(wait_for_frames(1));
  const int museum_port = coordinator->museum_port();
  const int node_port = coordinator->node_port();
  coordinator.reset();
  ASSERT_TRUE(listener.wait([](const auto& seen) { return !seen.reasons.empty(); }));
  EXPECT_THAT(listener.seen().reasons.front(), HasSubstr("the farm's coordinator stops"));
  start_coordinator(museum_port, node_port);
  client->request(view_of(2));
  ASSERT_TRUE(wait_for_frames(2));
  EXPECT_TRUE(listener.seen().frames.back().end.complete());
}

TEST_F(FarmTest, serves_two_museums_at_once) {
  start_coordinator(0, 0, {{"grotto", "a"}, {"relic", "b"}});
  std::vector<TestNode> nodes;
  for (int i = 0; i < 2; ++i) nodes.push_back(add_node());
  ASSERT_TRUE(wait_for_nodes(2));
  RecordingFarmListener other;
  const auto client = add_client(listener, "grotto");
  const auto other_client = add_client(other, "relic");
  for (std::uint64_t number = 1; number <= 20; ++number) {
    client->request(view_of(number));
    other_client->request(view_of(number, 300, 800));
  }
  const auto has_newest = [](const auto& seen) {
    return !seen.frames.empty() && seen.frames.back().view.number() == 20;
  };
  ASSERT_TRUE(listener.wait(has_newest));
  ASSERT_TRUE(other.wait(has_newest));
  for (const auto& frame : listener.seen().frames) EXPECT_EQ(composed(frame).width(), 1200);
  for (const auto& frame : other.seen().frames) EXPECT_EQ(composed(frame).width(), 300);
  EXPECT_EQ(listener.seen().scene.name(), "grotto");
  EXPECT_EQ(other.seen().scene.name(), "relic");
}

TEST_F(FarmTest, reports_what_is_wrong_with_a_session) {
  start_coordinator(0, 0, {{"grotto", "some/path"}, {"broken", "missing"}, {"large", "huge"}});
  TestNode node = add_node();
  ASSERT_TRUE(wait_for_nodes(1));
  for (const auto& [scene, reason] :
       {std::pair{"nowhere", "no scene 'nowhere'"}, {"broken", "no such file"}, {"large", "more memory"}}) {
    RecordingFarmListener to;
    const auto client = add_client(to, scene);
    const bool told = to.wait([&, wanted = reason](const auto& seen) {
      return std::ranges::any_of(seen.reasons, [&](const auto& r) { return r.find(wanted) != std::string::npos; });
    });
    EXPECT_TRUE(told) << scene;
  }
}

class RawSession {
 public:
  explicit RawSession(int port)
      : channel_(*make_channel("[::1]:" + std::to_string(port))), stub_(wire::Farm::NewStub(channel_)) {
    context_.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(20));
    stream_ = stub_->Session(&context_);
  }
  void open() {
    wire::SessionRequest request;
    request.mutable_open();
    stream_->Write(request);
  }
  void request_view(const wire::View& view) {
    wire::SessionRequest request;
    *request.mutable_view() = view;
    stream_->Write(request);
  }
  void close() { stream_->WritesDone(); }
  bool read(wire::SessionReply* reply) { return stream_->Read(reply); }
  grpc::Status end() {
    for (wire::SessionReply reply; stream_->Read(&reply);) continue;
    return stream_->Finish();
  }

 private:
  grpc::ClientContext context_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<wire::Farm::Stub> stub_;
  std::unique_ptr<grpc::ClientReaderWriter<wire::SessionRequest, wire::SessionReply>> stream_;
};

TEST_F(FarmTest, refuses_views_out_of_range_and_continues_for_others) {
  start_coordinator();
  TestNode node = add_node();
  ASSERT_TRUE(wait_for_nodes(1));
  const auto refusal_of = [&](const std::function<void(wire::View&)>& spoil) {
    RawSession session(coordinator->museum_port());
    session.open();
    wire::View view = view_of(1);
    spoil(view);
    session.request_view(view);
    const grpc::Status status = session.end();
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    return status.error_message();
  };
  EXPECT_THAT(refusal_of([](auto& v) { v.set_samples(0); }), HasSubstr("samples"));
  EXPECT_THAT(refusal_of([](auto& v) { v.set_number(0); }), HasSubstr("number"));
  EXPECT_THAT(refusal_of([](auto& v) { v.set_jpeg_quality(101); }), HasSubstr("jpeg_quality"));
  EXPECT_THAT(refusal_of([](auto& v) { v.set_heading_rad(std::numeric_limits<double>::infinity()); }),
              HasSubstr("heading"));
  EXPECT_THAT(refusal_of([](auto& v) { v.mutable_panorama()->set_width_px(20000); }), HasSubstr("width_px"));
  EXPECT_THAT(refusal_of([](auto& v) {
                v.mutable_panorama()->set_width_px(16384);
                v.mutable_panorama()->set_height_px(16384);
              }),
              HasSubstr("at most"));
  RawSession unopened(coordinator->museum_port());
  unopened.request_view(view_of(1));
  EXPECT_EQ(unopened.end().error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  RawSession twice(coordinator->museum_port());
  twice.open();
  twice.open();
  EXPECT_EQ(twice.end().error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  const auto client = add_client(listener);
  client->request(view_of(1));
  ASSERT_TRUE(wait_for_frames(1));
  EXPECT_TRUE(listener.seen().frames.front().end.complete());
}

TEST_F(FarmTest, ends_a_session_with_ok_when_the_museum_closes_it) {
  start_coordinator();
  TestNode node = add_node();
  ASSERT_TRUE(wait_for_nodes(1));
  RawSession session(coordinator->museum_port());
  session.open();
  session.close();
  EXPECT_TRUE(session.end().ok());
}

TEST_F(FarmTest, continues_for_others_when_a_museum_takes_no_messages) {
  start_coordinator();
  TestNode node = add_node();
  ASSERT_TRUE(wait_for_nodes(1));
  RawSession slow(coordinator->museum_port());
  slow.open();
  for (std::uint64_t number = 1; number <= 200; ++number) slow.request_view(view_of(number, 2000, 1000));
  const auto client = add_client(listener);
  for (std::uint64_t number = 1; number <= 30; ++number) {
    client->request(view_of(number));
    ASSERT_TRUE(wait_for_frames(number));
  }
}

grpc::Status refusal_of_node(int port, const std::vector<wire::NodeReport>& reports) {
  const auto stub = wire::Nodes::NewStub(*make_channel("[::1]:" + std::to_string(port)));
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(20));
  const auto stream = stub->Work(&context);
  for (const auto& report : reports) stream->Write(report);
  for (wire::NodeCommand command; stream->Read(&command);) continue;
  return stream->Finish();
}

TEST_F(FarmTest, disconnects_broken_nodes) {
  start_coordinator();
  wire::NodeReport hello;
  hello.mutable_hello()->set_version(CYCLORAMA_VERSION);
  hello.mutable_hello()->set_threads(1);
  wire::NodeReport other_version = hello;
  other_version.mutable_hello()->set_version("0.0.0");
  wire::NodeReport no_threads = hello;
  no_threads.mutable_hello()->set_threads(0);
  wire::NodeReport unasked_tile;
  unasked_tile.mutable_tile()->set_block(1);
  wire::NodeReport unasked_end;
  unasked_end.mutable_end()->set_block(7);
  wire::NodeReport unasked_scene;
  unasked_scene.mutable_scene_loaded()->set_scene("secret");
  wire::NodeReport empty_scene;
  empty_scene.mutable_scene_loaded()->set_scene("grotto");
  wire::NodeReport oversized = hello;
  oversized.mutable_hello()->set_name(std::string(17 << 20, 'x'));
  for (const auto& reports : std::vector<std::vector<wire::NodeReport>>{{other_version},
                                                                        {no_threads},
                                                                        {unasked_tile},
                                                                        {wire::NodeReport()},
                                                                        {hello, hello},
                                                                        {hello, unasked_tile},
                                                                        {hello, unasked_end},
                                                                        {hello, unasked_scene},
                                                                        {hello, empty_scene}}) {
    const grpc::Status status = refusal_of_node(coordinator->node_port(), reports);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << status.error_message();
  }
  EXPECT_FALSE(refusal_of_node(coordinator->node_port(), {oversized}).ok());
  TestNode good = add_node();
  ASSERT_TRUE(wait_for_nodes(1));
}

TEST_F(FarmTest, lists_its_scenes) {
  start_coordinator(0, 0, {{"grotto", "some/path"}, {"relic", "other"}});
  TestNode node = add_node();
  ASSERT_TRUE(wait_for_nodes(1));
  const auto stub = wire::Farm::NewStub(*make_channel("[::1]:" + std::to_string(coordinator->museum_port())));
  grpc::ClientContext context;
  wire::ListScenesReply reply;
  ASSERT_TRUE(stub->ListScenes(&context, {}, &reply).ok());
  ASSERT_EQ(reply.scenes_size(), 2);
  EXPECT_EQ(reply.scenes(0).name(), "grotto");
  EXPECT_EQ(reply.scenes(0).title(), "A plain room");
}

TEST_F(FarmTest, refuses_to_start_with_bad_options) {
  const auto refusal_of = [](CoordinatorOptions options) {
    options.museums = options.nodes = "[::1]:0";
    const auto started = Coordinator::start(options, [](const std::string&, const NoticeAbout&) {});
    return started ? "" : started.error().message();
  };
  EXPECT_THAT(refusal_of({}), HasSubstr("no scene"));
  EXPECT_THAT(refusal_of({.scenes = {{"a b", "x"}}}), HasSubstr("scene name"));
  EXPECT_THAT(refusal_of({.scenes = {{"a", ""}}}), HasSubstr("no path"));
  EXPECT_THAT(refusal_of({.scenes = {{"a", "/srv/Gr\xfcn"}}}), HasSubstr("UTF-8"));
  EXPECT_THAT(refusal_of({.scenes = {{"a", "x"}, {"a", "y"}}}), HasSubstr("twice"));
  EXPECT_EQ(refusal_of({.scenes = {{"a", "x"}}}), "");
}

}  // namespace
}  // namespace cyclorama::coordinator

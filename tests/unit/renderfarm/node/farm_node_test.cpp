// SPDX-License-Identifier: Apache-2.0
// A node over real gRPC on [::1], with coordinators that the test controls.
#include "renderfarm/node/farm_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <future>

#include "tests/doubles/fake_block_renderer.h"
#include "tests/doubles/scripted_coordinator.h"

namespace cyclorama::node {
namespace {

using testing::HasSubstr;
using Reports = std::vector<wire::NodeReport>;

wire::NodeCommand load(const std::string& scene, const std::string& path) {
  wire::NodeCommand command;
  command.mutable_load_scene()->set_scene(scene);
  command.mutable_load_scene()->set_path(path);
  return command;
}

/// A block of two tiles.
wire::NodeCommand block(std::uint64_t number) {
  wire::NodeCommand command;
  wire::RenderBlock& render = *command.mutable_render();
  render.set_block(number);
  render.set_scene("grotto");
  render.set_width_px(512);
  render.set_height_px(128);
  wire::View& view = *render.mutable_view();
  view.set_number(1);
  view.set_samples(1);
  view.set_jpeg_quality(90);
  view.mutable_panorama()->set_width_px(512);
  view.mutable_panorama()->set_height_px(128);
  view.mutable_panorama()->set_azimuth_span_rad(2.0);
  view.mutable_panorama()->set_tan_elevation_top(0.5);
  view.mutable_panorama()->set_tan_elevation_bottom(-0.5);
  return command;
}

auto count(std::size_t min, const std::function<bool(const wire::NodeReport&)>& is) {
  return [=](const Reports& reports) { return static_cast<std::size_t>(std::ranges::count_if(reports, is)) >= min; };
}
bool is_hello(const wire::NodeReport& report) { return report.has_hello(); }
bool is_status(const wire::NodeReport& report) { return report.has_status(); }
bool is_draining(const wire::NodeReport& report) { return report.status().draining(); }
bool is_loaded(const wire::NodeReport& report) { return report.has_scene_loaded(); }
bool is_tile(const wire::NodeReport& report) { return report.has_tile() && !report.tile().tile().jpeg().empty(); }
bool is_good_end(const wire::NodeReport& report) { return report.has_end() && report.end().error().empty(); }

class FarmNodeTest : public testing::Test {
 protected:
  std::unique_ptr<FarmNode> start(std::vector<std::string> coordinators) {
    auto started = FarmNode::start(
        {.coordinators = std::move(coordinators), .name = "r7", .memory_limit_bytes = 1 << 20}, fake_loader(rendering));
    EXPECT_TRUE(started) << started.error().message();
    return *std::move(started);
  }
  std::shared_ptr<FakeRendering> rendering = std::make_shared<FakeRendering>();
};

TEST_F(FarmNodeTest, serves_all_its_coordinators_at_once_and_continues_when_one_dies) {
  auto one = std::make_unique<ScriptedCoordinator>();
  ScriptedCoordinator other;
  const int port = one->port();
  const auto node = start({one->address(), other.address()});
  for (ScriptedCoordinator* const coordinator : {one.get(), &other}) {
    ASSERT_TRUE(coordinator->wait([](const Reports& reports) {
      return !reports.empty() && reports[0].hello().name() == "r7" &&
             reports[0].hello().memory_limit_bytes() == 1 << 20;
    }));
    ASSERT_TRUE(coordinator->wait(count(1, is_status)));
    coordinator->order(load("grotto", "a"));
    ASSERT_TRUE(coordinator->wait(count(1, is_loaded)));
    coordinator->order(block(1));
    ASSERT_TRUE(coordinator->wait(count(1, is_good_end)));
    EXPECT_TRUE(coordinator->wait(count(2, is_tile)));
  }
  rendering->set_gate(false);
  one->order(block(2));
  one.reset();
  rendering->set_gate(true);
  other.order(block(2));
  ASSERT_TRUE(other.wait(count(2, is_good_end)));
  ScriptedCoordinator again(port);
  ASSERT_TRUE(again.wait(count(1, is_hello)));
  ASSERT_TRUE(again.wait(count(2, is_status))) << "once a second";
  EXPECT_THAT(node->state(), HasSubstr("serving the coordinator at " + other.address()));
}

TEST_F(FarmNodeTest, drains_before_it_stops) {
  ScriptedCoordinator coordinator;
  const auto node = start({coordinator.address()});
  ASSERT_TRUE(coordinator.wait(count(1, is_hello)));
  coordinator.order(load("grotto", "a"));
  ASSERT_TRUE(coordinator.wait(count(1, is_loaded)));
  rendering->set_gate(false);
  coordinator.order(block(1));
  ASSERT_TRUE(coordinator.wait([](const Reports& reports) {
    return std::ranges::any_of(reports, [](const auto& r) { return r.status().blocks_waiting() == 1; });
  }));
  const auto drained = std::async(std::launch::async, [&] { node->drain(std::chrono::seconds(20)); });
  ASSERT_TRUE(coordinator.wait(count(1, is_draining)));
  coordinator.order(block(2));  // Ordered before the coordinator learns of the draining.
  rendering->set_gate(true);
  ASSERT_TRUE(coordinator.wait(count(2, is_good_end)));
  EXPECT_TRUE(coordinator.wait(count(4, is_tile)));
  EXPECT_TRUE(coordinator.wait_for_ended(1)) << "in order, not broken off";
  drained.wait();
  node->stop();
}

TEST_F(FarmNodeTest, abandons_what_is_not_done_in_time) {
  ScriptedCoordinator coordinator;
  const auto node = start({coordinator.address(), "[::1]:1"});
  ASSERT_TRUE(coordinator.wait(count(1, is_hello)));
  coordinator.order(load("grotto", "a"));
  ASSERT_TRUE(coordinator.wait(count(1, is_loaded)));
  rendering->set_gate(false);
  coordinator.order(block(1));
  node->drain(std::chrono::milliseconds(50));
  node->stop();
  EXPECT_TRUE(coordinator.wait(count(1, is_draining)));
  EXPECT_FALSE(coordinator.wait(count(1, is_good_end), Duration::zero()));
}

TEST_F(FarmNodeTest, disconnects_from_a_broken_coordinator_and_reconnects) {
  ScriptedCoordinator coordinator;
  const auto node = start({coordinator.address()});
  ASSERT_TRUE(coordinator.wait(count(1, is_hello)));
  coordinator.order(load("grotto", "a"));
  ASSERT_TRUE(coordinator.wait(count(1, is_loaded)));
  rendering->set_gate(false);
  coordinator.order(block(1));
  coordinator.order(block(1));
  ASSERT_TRUE(coordinator.wait(count(2, is_hello)));
  rendering->set_gate(true);
  coordinator.order(load("grotto", "a"));
  ASSERT_TRUE(coordinator.wait(count(2, is_loaded)));
  coordinator.order(block(1));
  EXPECT_TRUE(coordinator.wait(count(1, is_good_end)));
}

TEST_F(FarmNodeTest, refuses_to_start_without_a_valid_coordinator) {
  EXPECT_FALSE(FarmNode::start({}, fake_loader()));
  EXPECT_FALSE(FarmNode::start({.coordinators = {"[::1]:7402", "nowhere"}}, fake_loader()));
}

}  // namespace
}  // namespace cyclorama::node

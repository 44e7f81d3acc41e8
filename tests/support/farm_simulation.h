// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "renderfarm/balance/tiles.h"
#include "renderfarm/client/view_window.h"
#include "renderfarm/coordinator/coordinator_state.h"
#include "tests/doubles/fake_clock.h"
#include "tests/doubles/fake_farm.h"
#include "tests/doubles/recording_delegate.h"

namespace cyclorama {

inline wire::View view_of(std::uint64_t number, std::uint32_t width = 1024, std::uint32_t height = 512) {
  wire::View view;
  view.set_number(number);
  view.set_samples(1);
  view.set_jpeg_quality(80);
  view.mutable_panorama()->set_width_px(width);
  view.mutable_panorama()->set_height_px(height);
  view.mutable_panorama()->set_azimuth_span_rad(2.0);
  view.mutable_panorama()->set_tan_elevation_top(0.5);
  view.mutable_panorama()->set_tan_elevation_bottom(-0.5);
  return view;
}

/// A farm whose nodes and museums advance only when a test requests it.
class FarmSimulation {
 public:
  explicit FarmSimulation(coordinator::CoordinatorLimits limits = {})
      : state({{"grotto", "path"}}, balance::BalanceStrategy::kCostMapStealing, limits, clock, delegate) {}

  FakeClock clock;
  RecordingDelegate delegate;
  coordinator::CoordinatorState state;
  /// The clients' windows, which reject violations of farm.proto.
  std::map<coordinator::SessionId, client::ViewWindow> windows;
  std::map<coordinator::SessionId, std::uint64_t> answered;
  int complete = 0;
  int given_up = 0;

  coordinator::NodeId add_node(std::uint32_t threads = 1) {
    const coordinator::NodeId id{++last_id_};
    state.node_connected(id);
    wire::NodeReport report;
    report.mutable_hello()->set_version(CYCLORAMA_VERSION);
    report.mutable_hello()->set_threads(threads);
    report.mutable_hello()->set_name("node " + std::to_string(last_id_));
    state.node_reported(id, report);
    report.mutable_scene_loaded()->set_scene("grotto");
    *report.mutable_scene_loaded()->mutable_description() = fake_scene("grotto");
    report.mutable_scene_loaded()->set_can_compute_light(can_compute_light);
    report.mutable_scene_loaded()->set_memory_bytes(scene_memory_bytes);
    if (scene_bounces) report.mutable_scene_loaded()->set_bounces(*scene_bounces);
    state.node_reported(id, report);
    delegate.commands[id].clear();
    return id;
  }
  void kill(coordinator::NodeId id) {
    delegate.commands.erase(id);
    work_.erase(id);
    state.node_disconnected(id);
  }
  coordinator::SessionId add_session(double frame_budget_ms = 0.0, std::uint32_t reference_samples = 0) {
    const coordinator::SessionId id{++last_id_};
    state.session_connected(id);
    wire::SessionRequest request;
    request.mutable_open()->set_museum("museum");
    request.mutable_open()->set_frame_budget_ms(frame_budget_ms);
    request.mutable_open()->set_reference_samples(reference_samples);
    state.session_requested(id, request, clock.now());
    client::ViewWindow& window = windows[id];
    // The client may request a view at once, while the reply is still pending.
    if (!delegate.replies[id].empty()) {
      EXPECT_TRUE(window.take(delegate.replies[id].front()));
    }
    return id;
  }
  void request_view(coordinator::SessionId id, const wire::View& view) {
    windows.at(id).put(view);
    send_views(id);
  }
  /// Makes the museum take one message. Returns false if none is pending.
  bool take(coordinator::SessionId id) {
    auto& queue = delegate.replies[id];
    if (queue.empty()) return false;
    const wire::SessionReply reply = std::move(queue.front());
    queue.pop_front();
    client::ViewWindow& window = windows.at(id);
    const Status fine = reply.has_opened() ? Status(Done{}) : window.take(reply);
    if (reply.has_begin()) begun.push_back(reply.begin());
    if (reply.has_end()) {
      ++(reply.end().complete() ? complete : given_up);
      answered[id] = reply.end().view_number();
      last_end = reply.end();
    }
    EXPECT_TRUE(fine) << fine.error().message();
    state.written(id, reply);
    send_views(id);
    return true;
  }
  /// Makes the node take one step: a tile or a block's end. Returns false if the node has no work.
  bool work(coordinator::NodeId id, const std::string& error = "") {
    auto& queue = delegate.commands[id];
    for (const wire::NodeCommand& command : queue) {
      if (command.has_cancel()) cancelled_.insert(command.cancel().block());
    }
    std::erase_if(queue, [](const wire::NodeCommand& command) { return !command.has_render(); });
    if (queue.empty()) return false;
    const wire::RenderBlock order = queue.front().render();
    orders[order.block()] = {id, order};
    Work& now = work_[id];
    if (now.block != order.block()) {
      const auto cut = balance::tiles_of({static_cast<int>(order.x_px()), static_cast<int>(order.y_px()),
                                          static_cast<int>(order.width_px()), static_cast<int>(order.height_px())});
      now = {order.block(), {cut.begin(), cut.end()}};
    }
    if (!error.empty()) return end(id, order, error);
    if (cancelled_.count(order.block()) > 0) return end(id, order, "cancelled");
    if (now.tiles.empty()) return end(id, order, "");
    auto& tiles = now.tiles;
    wire::NodeReport report;
    report.mutable_tile()->set_block(order.block());
    wire::Tile& tile = *report.mutable_tile()->mutable_tile();
    tile.set_view_number(order.view().number());
    tile.set_x_px(static_cast<std::uint32_t>(tiles.front().x));
    tile.set_y_px(static_cast<std::uint32_t>(tiles.front().y));
    tile.set_width_px(static_cast<std::uint32_t>(tiles.front().width));
    tile.set_height_px(static_cast<std::uint32_t>(tiles.front().height));
    tile.set_jpeg(std::string(tile_bytes, 'j'));
    if (order.view().depth() || sends_depth_unasked) tile.set_depth(std::string(depth_bytes, 'd'));
    tiles.pop_front();
    state.node_reported(id, report);
    return true;
  }
  /// Runs the nodes and the museums until there is nothing left to do.
  void settle(const std::vector<coordinator::NodeId>& nodes) {
    for (bool moved = true; moved;) {
      moved = false;
      for (const coordinator::NodeId node : nodes) moved = work(node) || moved;
      for (auto& [id, window] : windows) {
        if (!delegate.ended_sessions.count(id)) moved = take(id) || moved;
      }
    }
  }
  wire::FrameEnd last_end;
  std::vector<wire::View> begun;  ///< Views of all frames that museums received.
  /// Blocks that nodes have begun, by number.
  std::map<std::uint64_t, std::pair<coordinator::NodeId, wire::RenderBlock>> orders;
  std::size_t tile_bytes = 10;
  std::size_t depth_bytes = 5;  ///< Size of a tile's depth, if the view requests it.
  bool sends_depth_unasked = false;
  bool can_compute_light = false;                ///< True if nodes can compute the scene's light.
  std::uint64_t scene_memory_bytes = 0;          ///< Size of the scene that nodes report if they are added from now on.
  std::optional<std::uint32_t> scene_bounces{};  ///< Number of bounces that nodes state when they load the scene.
  std::map<coordinator::NodeId, double> slowed;  ///< Factor by which other work on its host slows a node down.

 private:
  bool end(coordinator::NodeId id, const wire::RenderBlock& order, const std::string& error) {
    wire::NodeReport report;
    report.mutable_end()->set_block(order.block());
    const double seconds = 1e-7 * order.width_px() * order.height_px();
    report.mutable_end()->set_render_cpu_seconds(seconds);
    report.mutable_end()->set_wall_seconds(seconds * (slowed.contains(id) ? slowed.at(id) : 1.0));
    report.mutable_end()->set_error(error);
    delegate.commands[id].pop_front();
    state.node_reported(id, report);
    return true;
  }
  void send_views(coordinator::SessionId id) {
    while (const auto view = windows.at(id).take_sendable()) {
      wire::SessionRequest request;
      *request.mutable_view() = *view;
      state.session_requested(id, request, clock.now());
    }
  }
  std::uint64_t last_id_ = 0;
  struct Work {
    std::uint64_t block = 0;
    std::deque<PixelRect> tiles{};
  };
  std::map<coordinator::NodeId, Work> work_;
  std::set<std::uint64_t> cancelled_;
};

inline void drain_opened(FarmSimulation& s, coordinator::SessionId session) {
  ASSERT_FALSE(s.delegate.replies[session].empty());
  const auto opened = s.delegate.replies[session].front();
  ASSERT_TRUE(opened.has_opened());
  s.delegate.replies[session].pop_front();
  s.state.written(session, opened);
}

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
// Whatever nodes and museums send, the head neither crashes nor forgets itself, and breaks farm.proto towards no museum
// that keeps to it. Input: one byte says who speaks or what happens, one byte is a length, then that many bytes: of
// protobuf, or what chooses among messages that may well be right.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "renderfarm/balance/tiles.h"
#include "renderfarm/client/view_window.h"
#include "renderfarm/coordinator/coordinator_state.h"
#include "tests/doubles/fake_peers.h"
#include "tests/doubles/fake_scene.h"
#include "tests/fuzz/fuzz_input.h"

namespace {

using namespace cyclorama;

HeadLimits small_pictures() {
  HeadLimits limits;
  limits.picture_px = 1 << 20;
  return limits;
}

class Farm {
 public:
  Farm() {
    for (NodeId& node : nodes_) node = new_node();
    wire::VisitRequest open;
    for (Visit& visit : visits_) {
      visit = new_visit();
      open.mutable_open()->set_frame_budget_ms(&visit == &visits_[1] ? 50.0 : 0.0);
      if (&visit != &visits_[2]) ask(visit, open);
    }
  }

  void happen(unsigned what, std::span<const std::uint8_t> bytes) {
    FuzzInput input(bytes);
    NodeId& node = nodes_[what / 8 % nodes_.size()];
    Visit& visit = visits_[what / 8 % visits_.size()];
    wire::NodeReport report;
    wire::VisitRequest request;
    const auto parses = [&](auto* message) {
      return message->ParseFromArray(bytes.data(), static_cast<int>(bytes.size()));
    };
    switch (what % 8) {
      case 0:
        if (parses(&report)) state_.node_reported(node, report);
        break;
      case 1:
        work(node, &input);
        break;
      case 2:
        if (!parses(&request)) break;
        visit.is_sound = false;
        ask(visit, request);
        break;
      case 3:
        look(visit, &input);
        break;
      case 4:
        state_.node_gone(node);
        peers_.commands.erase(node);
        if (input.byte() % 2 == 1) node = new_node();
        break;
      case 5:
        state_.visit_gone(visit.id);
        peers_.replies.erase(visit.id);
        if (input.byte() % 2 == 1) visit = new_visit();
        break;
      case 6:
        clock_.advance(std::chrono::milliseconds(50) * input.byte());
        // The head reads each of its own scenes once.
        if (input.byte() % 4 == 3 && !std::exchange(is_read_, true)) state_.scene_read("c", std::string(64, 'd'));
        break;
      case 7:
        take_all();
        break;
    }
    state_.tick();
  }

  /// The museums take at once what they are sent.
  void take_all() {
    for (bool moved = true; moved;) {
      moved = false;
      for (Visit& visit : visits_) {
        auto& queue = peers_.replies[visit.id];
        if (queue.empty()) continue;
        const wire::VisitReply reply = std::move(queue.front());
        queue.pop_front();
        if (visit.is_sound) CHECK(visit.window.take(reply));
        state_.written(visit.id, reply);
        moved = true;
      }
    }
  }

 private:
  struct Visit {
    SessionId id{};
    ViewWindow window{};
    std::uint64_t newest = 0;
    bool is_sound = true;  ///< It sent only what farm.proto lets it.
  };

  /// One that has a scene, so that views lead to blocks.
  NodeId new_node() {
    const NodeId id{++last_id_};
    state_.node_came(id);
    wire::NodeReport report;
    report.mutable_hello()->set_version(CYCLORAMA_VERSION);
    report.mutable_hello()->set_threads(2);
    state_.node_reported(id, report);
    report.mutable_scene_loaded()->set_scene("a");
    *report.mutable_scene_loaded()->mutable_description() = fake_scene("a");
    if (last_id_ != 3) state_.node_reported(id, report);
    return id;
  }
  Visit new_visit() {
    const SessionId id{++last_id_};
    state_.visit_came(id);
    return {id};
  }
  void ask(Visit& visit, const wire::VisitRequest& request) { state_.visit_asked(visit.id, request, clock_.now()); }

  /// A museum as it should be: opens, then asks for what its window lets through.
  void look(Visit& visit, FuzzInput* input) {
    wire::VisitRequest request;
    if (!visit.is_sound) return;
    if (input->byte() % 8 == 7) {
      request.mutable_open()->set_scene(input->byte() % 2 == 0 ? "" : "b");
      request.mutable_open()->set_frame_budget_ms(input->byte());
      visit.is_sound = !visit.window.is_opened();
      return ask(visit, request);
    }
    take_all();
    wire::View view;
    view.set_number(++visit.newest);
    view.set_samples(1 + input->byte() % 8);
    view.set_jpeg_quality(80);
    view.mutable_panorama()->set_width_px(16 + 4 * input->byte());
    view.mutable_panorama()->set_height_px(16 + 2 * input->byte());
    view.mutable_panorama()->set_azimuth_span_rad(1.0);
    view.mutable_panorama()->set_tan_elevation_top(0.5);
    visit.window.put(view);
    while (const auto sendable = visit.window.take_sendable()) {
      *request.mutable_view() = *sendable;
      ask(visit, request);
    }
  }

  /// The node does what it was told first, or says something of itself.
  void work(NodeId id, FuzzInput* input) {
    auto& queue = peers_.commands[id];
    wire::NodeReport report;
    const std::uint32_t how = input->byte();
    if (how % 8 == 6) {
      report.mutable_status()->set_draining(input->byte() % 2 == 1);
      report.mutable_status()->set_blocks_waiting(input->byte());
      return state_.node_reported(id, report);
    }
    if (how % 8 == 7) {
      report.mutable_scene_dropped()->set_scene(input->byte() % 2 == 0 ? "a" : "b");
      return state_.node_reported(id, report);
    }
    if (queue.empty()) return;
    const wire::NodeCommand command = queue.front();
    queue.pop_front();
    if (command.has_load_scene()) {
      report.mutable_scene_loaded()->set_scene(command.load_scene().scene());
      report.mutable_scene_loaded()->set_error(how % 8 == 5 ? "no disk" : "");
      report.mutable_scene_loaded()->set_probe_cpu_seconds(0.01 * input->byte());
      *report.mutable_scene_loaded()->mutable_description() = fake_scene(command.load_scene().scene());
      state_.node_reported(id, report);
    } else if (command.has_render()) {
      render(id, command.render(), how % 8 == 5 ? 0 : 1 + input->byte(), input);
    }
  }
  /// At most so many tiles, and an end; without any it failed.
  void render(NodeId id, const wire::RenderBlock& order, std::uint32_t most, FuzzInput* input) {
    state_.order_written(id, order.block(), clock_.now());
    wire::NodeReport report;
    std::uint32_t delivered = 0;
    for (const PixelRect& rect : tiles_of({static_cast<int>(order.x_px()), static_cast<int>(order.y_px()),
                                           static_cast<int>(order.width_px()), static_cast<int>(order.height_px())})) {
      if (delivered++ == most) break;
      report.mutable_tile()->set_block(order.block());
      wire::Tile& tile = *report.mutable_tile()->mutable_tile();
      tile.set_view_number(order.view().number());
      tile.set_x_px(static_cast<std::uint32_t>(rect.x));
      tile.set_y_px(static_cast<std::uint32_t>(rect.y));
      tile.set_width_px(static_cast<std::uint32_t>(rect.width));
      tile.set_height_px(static_cast<std::uint32_t>(rect.height));
      tile.set_jpeg("jpeg");
      state_.node_reported(id, report);
    }
    wire::BlockEnd& end = *report.mutable_end();
    end.set_block(order.block());
    end.set_error(most == 0 ? "no memory" : "");
    end.set_render_cpu_seconds(0.001 * input->byte());
    end.set_encode_cpu_seconds(0.0001 * input->byte());
    end.set_wall_seconds(0.001 * input->byte());
    const std::uint32_t cells = (order.width_px() + 15) / 16 * ((order.height_px() + 15) / 16);
    const std::uint32_t measured = input->byte() % 4 == 3 ? cells + 1 : cells;
    for (std::uint32_t i = 0; i < measured; ++i) end.add_cell_cpu_seconds(0.0001F * static_cast<float>(i % 7));
    state_.node_reported(id, report);
  }

  FakeClock clock_;
  FakePeers peers_;
  HeadState state_{
      {{"a", "a"}, {"b", "b"}, {"c", "c", true}}, BalanceStrategy::kCostMapStealing, small_pictures(), clock_, peers_};
  std::uint64_t last_id_ = 0;
  std::array<NodeId, 3> nodes_{};
  std::array<Visit, 3> visits_{};
  bool is_read_ = false;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Farm farm;
  std::span<const std::uint8_t> left(data, size);
  while (left.size() >= 2) {
    const std::size_t length = std::min<std::size_t>(left[1], left.size() - 2);
    farm.happen(left[0], left.subspan(2, length));
    left = left.subspan(2 + length);
  }
  farm.take_all();
  return 0;
}

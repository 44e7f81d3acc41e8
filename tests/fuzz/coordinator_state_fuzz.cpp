// SPDX-License-Identifier: Apache-2.0
// Whatever nodes and museums send, the coordinator neither crashes nor loses its consistency, and it never violates
// farm.proto towards a museum that complies with it. Input: one byte selects the sender or event, one byte is a length,
// followed by that many bytes: protobuf, or choices among messages that are probably valid.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "renderfarm/balance/tiles.h"
#include "renderfarm/client/view_window.h"
#include "renderfarm/coordinator/coordinator_state.h"
#include "tests/doubles/fake_clock.h"
#include "tests/doubles/fake_scene.h"
#include "tests/doubles/recording_delegate.h"
#include "tests/fuzz/fuzz_input.h"

namespace {

using namespace cyclorama;

coordinator::CoordinatorLimits small_pictures() {
  coordinator::CoordinatorLimits limits;
  limits.picture_px = 1 << 20;
  return limits;
}

class Farm {
 public:
  Farm() {
    for (coordinator::NodeId& node : nodes_) node = new_node();
    wire::SessionRequest open;
    for (Session& session : sessions_) {
      session = new_visit();
      open.mutable_open()->set_frame_budget_ms(&session == &sessions_[1] ? 50.0 : 0.0);
      if (&session != &sessions_[2]) ask(session, open);
    }
  }

  void happen(unsigned what, std::span<const std::uint8_t> bytes) {
    FuzzInput input(bytes);
    coordinator::NodeId& node = nodes_[what / 8 % nodes_.size()];
    Session& session = sessions_[what / 8 % sessions_.size()];
    wire::NodeReport report;
    wire::SessionRequest request;
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
        session.is_sound = false;
        ask(session, request);
        break;
      case 3:
        look(session, &input);
        break;
      case 4:
        state_.node_disconnected(node);
        delegate_.commands.erase(node);
        if (input.byte() % 2 == 1) node = new_node();
        break;
      case 5:
        state_.session_disconnected(session.id);
        delegate_.replies.erase(session.id);
        if (input.byte() % 2 == 1) session = new_visit();
        break;
      case 6:
        clock_.advance(std::chrono::milliseconds(50) * input.byte());
        // The coordinator reads each of its own scenes once.
        if (input.byte() % 4 == 3 && !std::exchange(is_read_, true)) state_.scene_read("c", std::string(64, 'd'));
        break;
      case 7:
        take_all();
        break;
    }
    state_.tick();
  }

  /// Lets the museums take all pending messages.
  void take_all() {
    for (bool moved = true; moved;) {
      moved = false;
      for (Session& session : sessions_) {
        auto& queue = delegate_.replies[session.id];
        if (queue.empty()) continue;
        const wire::SessionReply reply = std::move(queue.front());
        queue.pop_front();
        if (session.is_sound) CHECK(session.window.take(reply));
        state_.written(session.id, reply);
        moved = true;
      }
    }
  }

 private:
  struct Session {
    coordinator::SessionId id{};
    client::ViewWindow window{};
    std::uint64_t newest = 0;
    bool is_sound = true;  ///< True while it has complied with farm.proto.
  };

  /// Adds a node that has a scene, so that views lead to blocks.
  coordinator::NodeId new_node() {
    const coordinator::NodeId id{++last_id_};
    state_.node_connected(id);
    wire::NodeReport report;
    report.mutable_hello()->set_version(CYCLORAMA_VERSION);
    report.mutable_hello()->set_threads(2);
    state_.node_reported(id, report);
    report.mutable_scene_loaded()->set_scene("a");
    *report.mutable_scene_loaded()->mutable_description() = fake_scene("a");
    if (last_id_ != 3) state_.node_reported(id, report);
    return id;
  }
  Session new_visit() {
    const coordinator::SessionId id{++last_id_};
    state_.session_connected(id);
    return {id};
  }
  void ask(Session& session, const wire::SessionRequest& request) {
    state_.session_requested(session.id, request, clock_.now());
  }

  /// A museum that complies: opens a session, then requests what its window permits.
  void look(Session& session, FuzzInput* input) {
    wire::SessionRequest request;
    if (!session.is_sound) return;
    if (input->byte() % 8 == 7) {
      request.mutable_open()->set_scene(input->byte() % 2 == 0 ? "" : "b");
      request.mutable_open()->set_frame_budget_ms(input->byte());
      session.is_sound = !session.window.is_opened();
      return ask(session, request);
    }
    take_all();
    wire::View view;
    view.set_number(++session.newest);
    view.set_samples(1 + input->byte() % 8);
    view.set_jpeg_quality(80);
    view.mutable_panorama()->set_width_px(16 + 4 * input->byte());
    view.mutable_panorama()->set_height_px(16 + 2 * input->byte());
    view.mutable_panorama()->set_azimuth_span_rad(1.0);
    view.mutable_panorama()->set_tan_elevation_top(0.5);
    session.window.put(view);
    while (const auto sendable = session.window.take_sendable()) {
      *request.mutable_view() = *sendable;
      ask(session, request);
    }
  }

  /// The node executes its first pending command, or sends a message of its own.
  void work(coordinator::NodeId id, FuzzInput* input) {
    auto& queue = delegate_.commands[id];
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
  /// Sends at most `max` tiles and an end; without tiles the block failed.
  void render(coordinator::NodeId id, const wire::RenderBlock& order, std::uint32_t max, FuzzInput* input) {
    state_.order_written(id, order.block(), clock_.now());
    wire::NodeReport report;
    std::uint32_t delivered = 0;
    for (const PixelRect& rect :
         balance::tiles_of({static_cast<int>(order.x_px()), static_cast<int>(order.y_px()),
                            static_cast<int>(order.width_px()), static_cast<int>(order.height_px())})) {
      if (delivered++ == max) break;
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
    end.set_error(max == 0 ? "no memory" : "");
    end.set_render_cpu_seconds(0.001 * input->byte());
    end.set_encode_cpu_seconds(0.0001 * input->byte());
    end.set_wall_seconds(0.001 * input->byte());
    const std::uint32_t cells = (order.width_px() + 15) / 16 * ((order.height_px() + 15) / 16);
    const std::uint32_t measured = input->byte() % 4 == 3 ? cells + 1 : cells;
    for (std::uint32_t i = 0; i < measured; ++i) end.add_cell_cpu_seconds(0.0001F * static_cast<float>(i % 7));
    state_.node_reported(id, report);
  }

  FakeClock clock_;
  RecordingDelegate delegate_;
  coordinator::CoordinatorState state_{{{"a", "a"}, {"b", "b"}, {"c", "c", true}},
                                       balance::BalanceStrategy::kCostMapStealing,
                                       small_pictures(),
                                       clock_,
                                       delegate_};
  std::uint64_t last_id_ = 0;
  std::array<coordinator::NodeId, 3> nodes_{};
  std::array<Session, 3> sessions_{};
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

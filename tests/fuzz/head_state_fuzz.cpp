// SPDX-License-Identifier: Apache-2.0
// Whatever a node or a museum sends, the head neither crashes nor forgets itself: messages are read from the input and
// given to HeadState. Input: one byte says who speaks or what happens, one byte is a length, then that many bytes of
// protobuf.
#include <cstddef>
#include <cstdint>

#include "renderfarm/head/head_state.h"
#include "tests/doubles/fake_farm.h"
#include "tests/doubles/fake_peers.h"

namespace {

using namespace cyclorama;

/// The museums take at once what they are sent.
void take_all(HeadState& state, FakePeers& peers) {
  for (bool moved = true; moved;) {
    moved = false;
    for (auto& [id, queue] : peers.replies) {
      if (queue.empty()) continue;
      const wire::VisitReply reply = std::move(queue.front());
      queue.pop_front();
      state.written(id, reply);
      moved = true;
    }
  }
}

/// Two nodes that are ready, so that views lead to blocks.
void greet(HeadState& state, NodeId id) {
  state.node_came(id);
  wire::NodeReport report;
  report.mutable_hello()->set_version(CYCLORAMA_VERSION);
  report.mutable_hello()->set_threads(2);
  state.node_reported(id, report);
  report.mutable_scene_loaded()->set_scene("a");
  *report.mutable_scene_loaded()->mutable_description() = fake_scene("a");
  state.node_reported(id, report);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FakeClock clock;
  FakePeers peers;
  HeadLimits limits;
  limits.picture_px = 1 << 20;
  HeadState state({{"a", "a"}, {"b", "b"}}, BalanceStrategy::kPbt, limits, clock, peers);
  greet(state, NodeId{1});
  greet(state, NodeId{2});
  state.node_came(NodeId{3});
  wire::VisitRequest open;
  open.mutable_open();
  for (std::uint64_t id = 1; id <= 3; ++id) {
    state.visit_came(SessionId{id});
    open.mutable_open()->set_frame_budget_ms(id == 2 ? 50.0 : 0.0);
    if (id < 3) state.visit_asked(SessionId{id}, open, clock.now());
  }
  while (size >= 2) {
    const unsigned who = data[0];
    const std::size_t length = std::min<std::size_t>(data[1], size - 2);
    const int bytes = static_cast<int>(length);
    const std::uint64_t id = 1 + who / 8 % 3;
    wire::NodeReport report;
    wire::VisitRequest request;
    switch (who % 8) {
      case 0:
      case 1:
        if (report.ParseFromArray(data + 2, bytes)) state.node_reported(NodeId{id}, report);
        break;
      case 2:
      case 3:
        if (request.ParseFromArray(data + 2, bytes)) state.visit_asked(SessionId{id}, request, clock.now());
        break;
      case 4:
        state.node_gone(NodeId{id});
        break;
      case 5:
        state.visit_gone(SessionId{id});
        break;
      case 6:
        clock.advance(std::chrono::milliseconds(50 * length));
        break;
      case 7:
        take_all(state, peers);
        break;
    }
    state.tick();
    data += 2 + length;
    size -= 2 + length;
  }
  take_all(state, peers);
  return 0;
}

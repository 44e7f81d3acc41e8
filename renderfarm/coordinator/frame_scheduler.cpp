// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/frame_scheduler.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/base/check.h"
#include "common/base/text.h"
#include "common/wire/convert.h"
#include "common/wire/payload.h"
#include "renderfarm/coordinator/frame_report.h"
#include "renderfarm/coordinator/session_governor.h"

namespace cyclorama::coordinator {
namespace {

constexpr std::size_t kMaxReasonBytes = 200;

/// Checks everything about a tile except that it belongs to its block.
Status check_tile(const wire::Tile& tile, const wire::View& view) {
  if (tile.view_number() != view.number()) return broken("it is of another view");
  if (tile.jpeg().empty()) return broken("it is empty");
  if (!tile.depth().empty() && !view.depth()) return broken("it has depth, which its view does not request");
  return validate(tile, static_cast<int>(view.panorama().width_px()), static_cast<int>(view.panorama().height_px()));
}

/// Precondition: check_tile() accepted the tile.
PixelRect rect_of(const wire::Tile& tile) {
  return {static_cast<int>(tile.x_px()), static_cast<int>(tile.y_px()), static_cast<int>(tile.width_px()),
          static_cast<int>(tile.height_px())};
}

}  // namespace

void FrameScheduler::request(Session& session, const wire::View& view, TimePoint received_at) {
  session.newest_view = view.number();
  session.views.put(view.number(), {view, received_at});
  if (session.governed) parts_.resting.leave(session);
}

void FrameScheduler::advance(SessionId id) {
  Session& session = parts_.sessions.at(id);
  for (;;) {
    while (!session.frames.empty()) {
      FrameInFlight& frame = session.frames.front();
      if (!frame.begun && !frame.refines) begin(id, session, frame);
      if (!frame.is_over()) break;
      finish(id, session, frame);
      session.frames.pop_front();
      session.due.earliest = TimePoint::min();
    }
    if (session.governed && session.governed->refinement) refine(id, session);
    CHECK(session.views.in_flight() == session.frames.size() + session.unwritten_ends.size());
    if (!session.views.is_sendable()) return;
    if (parts_.nodes.count_with(session.scene) == 0) break;
    plan(id, session);
  }
  parts_.closer.end(id, parts_.scenes.unavailable_reason(session.scene), false);
}

void FrameScheduler::advance_all(const std::set<SessionId>& sessions) {
  for (const SessionId id : sessions) advance(id);
}

void FrameScheduler::plan(SessionId id, Session& session) {
  FrameInFlight& frame = session.frames.emplace_back();
  frame.id = parts_.planner.next_frame();
  const ReceivedView* const next = session.views.send();
  frame.view = next->view;
  frame.received_at = next->received_at;
  frame.turn_began_at = parts_.clock.now();
  frame.last_tile_at = parts_.clock.now();
  frame.asked_px = std::int64_t{frame.view.panorama().width_px()} * frame.view.panorama().height_px();
  if (session.governed) govern(*session.governed, &frame);
  parts_.lights.name(session.scene, &frame.view);
  parts_.planner.take_turn(session, &frame);
  const std::vector<AssignedBlock> blocks = parts_.planner.split(id, session, frame.view, frame.view.denoise());
  if (frame.turn.work == WorkClass::kMoving) parts_.planner.place(id, session, blocks);
  order(id, session, frame, blocks);
}

void FrameScheduler::refine(SessionId id, Session& session) {
  const std::vector<AssignedBlock> blocks = parts_.resting.begin(id, session);
  if (blocks.empty()) return;
  order(id, session, session.frames.back(), blocks);
  session.due = parts_.deadlines.due(session);
}

void FrameScheduler::order(SessionId id, Session& session, FrameInFlight& frame,
                           const std::vector<AssignedBlock>& blocks) {
  const std::uint64_t first_block = parts_.orders.last_number() + 1;
  frame.threads = parts_.planner.threads_of(blocks);
  for (const AssignedBlock& block : blocks) {
    frame.assembly.plan(parts_.orders.next_number(), block.node, block.rect, block.forecast);
  }
  frame.last_planned = parts_.orders.last_number();
  frame.planned_at = parts_.clock.now();
  // The fan-out begins here: the first order of a stream is written immediately, on this thread.
  std::uint64_t number = first_block;
  for (const AssignedBlock& block : blocks) {
    parts_.orders.order(id, session, frame, number++, block.node, block.rect);
  }
}

void FrameScheduler::begin(SessionId id, Session& session, FrameInFlight& frame) {
  frame.begun = true;
  frame.foremost_since = parts_.clock.now();
  session.due.earliest = TimePoint::min();
  wire::SessionReply reply;
  *reply.mutable_begin() = frame.view;
  parts_.sessions.send(id, session, std::move(reply));
  for (wire::Tile& tile : frame.held) relay(id, session, std::move(tile));
  frame.held.clear();
}

void FrameScheduler::relay(SessionId id, Session& session, wire::Tile tile) {
  wire::SessionReply reply;
  *reply.mutable_tile() = std::move(tile);
  parts_.sessions.send(id, session, std::move(reply));
}

void FrameScheduler::finish(SessionId id, Session& session, FrameInFlight& frame) {
  if (!frame.failure) parts_.orders.cancel(frame);  // Cancels stragglers whose tiles other nodes delivered.
  const FrameReport report = report_of(id, session, frame, parts_.nodes, parts_.clock.now());
  parts_.planner.finish(session, frame, report);
  if (!frame.refines) {
    if (report.complete) session.learn_pace(to_seconds(parts_.clock.now() - frame.foremost_since));
    end(id, session, frame, report);
  } else if (parts_.resting.finish(session, frame)) {
    begin(id, session, frame);
    end(id, session, frame, report);
  }
  parts_.delegate.frame_ended(report);
}

void FrameScheduler::end(SessionId id, Session& session, const FrameInFlight& frame, const FrameReport& report) {
  wire::SessionReply reply;
  *reply.mutable_end() = end_of(session, frame, report);
  session.unwritten_ends.push_back(to_be_written(frame, report));
  parts_.sessions.send(id, session, std::move(reply));
}

void FrameScheduler::written(SessionId id, const wire::SessionReply& reply) {
  Session* const session = parts_.sessions.find(id);
  if (session == nullptr) return;
  parts_.sessions.written(*session, reply);
  if (!reply.has_end()) return;
  const WrittenFrame frame = session->unwritten_ends.front();
  session->unwritten_ends.pop_front();
  session->views.finish(frame.view_number);
  if (session->governed) learn(*session->governed, frame, parts_.clock.now());
  advance(id);
  watch(id);
}

void FrameScheduler::order_written(NodeId id, std::uint64_t block, TimePoint at) {
  const auto node = parts_.nodes.find(id);
  if (node == parts_.nodes.end()) return;
  const auto place = node->second.blocks.find(block);
  FrameInFlight* const frame = place == node->second.blocks.end() ? nullptr : parts_.sessions.find_frame(place->second);
  if (frame != nullptr && block <= frame->last_planned) frame->fanned_out_at = std::max(frame->fanned_out_at, at);
}

Status FrameScheduler::tile_received(Node& node, wire::BlockTile& message) {
  const auto place = node.blocks.find(message.block());
  if (place == node.blocks.end())
    return broken(fmt::format("it sent a tile of block {}, not its own", message.block()));
  FrameInFlight* const frame = parts_.sessions.find_frame(place->second);
  if (frame == nullptr || frame->failure) return Done{};  // The tile is no longer wanted.
  wire::Tile& tile = *message.mutable_tile();
  if (const Status usable = check_tile(tile, frame->view); !usable) {
    return broken(fmt::format("it sent a tile of block {}: {}", message.block(), usable.error().message()));
  }
  const auto verdict = frame->assembly.accept(message.block(), rect_of(tile));
  if (verdict == FrameAssembly::Verdict::kForeign) {
    return broken(fmt::format("it sent a tile that is not in block {}", message.block()));
  }
  if (verdict == FrameAssembly::Verdict::kDuplicate) return Done{};
  const SessionId id = place->second.session;
  Session& session = parts_.sessions.at(id);
  frame->bytes += payload_bytes(tile);
  frame->last_tile_at = parts_.clock.now();
  session.bytes_waiting += payload_bytes(tile);
  if (frame->begun) {
    relay(id, session, std::move(tile));
  } else {
    frame->held.push_back(std::move(tile));
  }
  if (session.bytes_waiting > max_session_bytes_) {
    parts_.orders.give_up(
        *frame, "the museum receives pictures more slowly than the farm renders them, or they are too large", session);
  }
  advance(id);
  return Done{};
}

Status FrameScheduler::block_ended(NodeId id, Node& node, const wire::BlockEnd& end) {
  const std::optional<BlockLocation> place = parts_.orders.end(node, end);
  if (!place) return broken(fmt::format("it ended block {}, not its own", end.block()));
  NodeSpeeds::learn(&node, end, parts_.clock.now());
  FrameInFlight* const frame = parts_.sessions.find_frame(*place);
  if (frame == nullptr || frame->failure) return Done{};
  Session& session = parts_.sessions.at(place->session);
  frame->assembly.end(end.block(), end);
  const std::vector<PixelRect> orphans = frame->assembly.give_up(end.block());
  if (!orphans.empty()) {
    parts_.delegate.notice(
        fmt::format("{} did not finish a block: {}; other nodes take over", title_of(node),
                    end.error().empty() ? "it gave no reason" : printable(end.error(), kMaxReasonBytes)),
        {.node = node.name, .is_trouble = true});
    parts_.reassignment.reassign(place->session, session, *frame, orphans, id);
  }
  parts_.reassignment.move_block_to_idle(place->session, session, *frame, id);
  advance(place->session);
  watch(place->session);
  return Done{};
}

Status FrameScheduler::block_progressed(Node& node, const wire::BlockProgress& progress) {
  if (parts_.orders.progress(node, progress)) return Done{};
  return broken(fmt::format("it reports block {}, not its own", progress.block()));
}

void FrameScheduler::lose(const std::map<std::uint64_t, BlockLocation>& blocks, NodeId gone) {
  advance_all(parts_.reassignment.lose(blocks, gone));
}

void FrameScheduler::watch(SessionId id) {
  const Session* const before = parts_.sessions.find(id);
  // Work only moves deadlines to later times, so there is nothing to do before the earliest one.
  if (before == nullptr || parts_.clock.now() < before->due.earliest) return;
  meet_deadlines(id);
  Session* const session = parts_.sessions.find(id);
  if (session != nullptr) session->due = parts_.deadlines.due(*session);
}

void FrameScheduler::meet_deadlines(SessionId id) {
  Session* const session = parts_.sessions.find(id);
  if (session == nullptr || session->frames.empty()) return;
  FrameInFlight& frame = session->frames.front();
  if (!frame.begun && !frame.refines) return;
  std::set<SessionId> changed;
  const bool has_successor = session->views.is_waiting() || session->frames.size() > 1;
  if (has_successor && parts_.deadlines.is_late(*session, frame)) {
    const double taken = to_seconds(parts_.clock.now() - frame.foremost_since);
    session->miss_pace();
    frame.late = true;
    parts_.orders.give_up(
        frame, fmt::format("late: incomplete after {:.0f} ms; the last complete picture stands in for it", 1e3 * taken),
        *session);
    changed.insert(id);
  }
  for (const NodeId node : parts_.deadlines.silent_nodes(*session, frame)) {
    changed.merge(parts_.reassignment.retire(node, session->account));
  }
  advance_all(changed);
}

TimePoint FrameScheduler::next_deadline() const {
  const TimePoint now = parts_.clock.now();
  TimePoint next = TimePoint::max();
  for (const auto& [id, session] : parts_.sessions) {
    // A deadline in the past has been handled already, or waits for another event.
    if (session.due.next > now) next = std::min(next, session.due.next);
  }
  return next;
}

}  // namespace cyclorama::coordinator

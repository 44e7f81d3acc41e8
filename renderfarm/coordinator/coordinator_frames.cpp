// SPDX-License-Identifier: Apache-2.0
// The stages of a frame, from a waiting view to the frame's end.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "common/wire/convert.h"
#include "common/wire/payload.h"
#include "renderfarm/coordinator/coordinator_state.h"

namespace cyclorama::coordinator {
namespace {

/// Overhead of a block in seconds: one tile and its acknowledgement through gRPC with TLS.
constexpr double kBlockSeconds = 0.0003;
/// Overhead of one more node in seconds, until its orders are written; measured as the fan-out of `./bench.sh
/// farm-overhead`. The node's tiles arrive while other nodes render.
constexpr double kNodeSeconds = 0.00005;
/// Minimum cost in cpu-seconds, so that a frame without a measured cost still takes its turn.
constexpr double kMinCpuSeconds = 1e-4;

/// Fraction of the credit by which an account's service must differ from the value last stated to a node before it is
/// stated again.
constexpr double kNoticeable = 0.1;
/// Maximum accounts that one order states.
constexpr int kMaxStated = 16;

void add_stage(wire::FrameEnd* end, const char* name, double seconds) {
  wire::StageTime* const stage = end->add_stages();
  stage->set_name(name);
  stage->set_seconds(seconds);
}

balance::PictureSize size_of(const wire::View& view) {
  return {static_cast<int>(view.panorama().width_px()), static_cast<int>(view.panorama().height_px())};
}

std::array<double, 3> eye_of(const wire::View& view) { return {view.eye_m().x(), view.eye_m().y(), view.eye_m().z()}; }

/// Returns the azimuth span in radians; 0 for a picture that a change of heading does not shift.
double shifting_span(const wire::View& view) {
  return view.panorama().projection() == wire::Panorama::CYLINDER ? view.panorama().azimuth_span_rad() : 0.0;
}

/// Returns the number of pictures, one above another: one per eye.
int stacked(const wire::View& view) { return view.panorama().has_eyes() ? 2 : 1; }

/// Returns the relative cost of a pixel, which grows with its samples; the extra cost of a bounce depends on the scene.
double effort_of(const wire::View& view) { return view.samples(); }

/// Returns the thread time of the busiest node over its threads, in ms; 0 for a frame that its nodes did not finish.
double rays_ms(const FrameReport& report) {
  if (!report.complete || report.reassigned || report.loads.empty()) return 0.0;
  return 1e3 * *std::ranges::max_element(report.loads);
}

}  // namespace

FrameInFlight* CoordinatorState::find_frame(const BlockLocation& place) {
  const auto session = sessions_.find(place.session);
  if (session == sessions_.end()) return nullptr;
  auto& frames = session->second.frames;
  const auto frame = std::ranges::find(frames, place.frame, &FrameInFlight::id);
  return frame == frames.end() ? nullptr : &*frame;
}

std::vector<AssignedBlock> CoordinatorState::split(SessionId id, Session& session, const wire::View& view,
                                                   bool whole_blocks) {
  std::vector<NodeId> nodes = nodes_.able(session.scene, session.account, view.light());
  placement_.arrange(id, &nodes);
  std::vector<double> speeds;
  std::vector<double> thread_speeds;
  for (const NodeId at : nodes) {
    const Node& node = nodes_.at(at);
    speeds.push_back(speeds_.of(node, session.scene) * placement_.free_part(id, at));
    thread_speeds.push_back(node.scenes.at(session.scene).speed);
  }
  balance::SplitRequest request{size_of(view), speeds, view.heading_rad(), shifting_span(view)};
  request.eye_m = eye_of(view);
  request.effort = effort_of(view);
  request.stacked = stacked(view);
  request.block_overhead_seconds = kBlockSeconds;
  request.node_overhead_seconds = kNodeSeconds;
  request.whole_blocks = whole_blocks;
  std::vector<AssignedBlock> blocks;
  for (const balance::PlannedBlock& block : session.balancer->split(request)) {
    blocks.push_back(
        {nodes[block.node], block.rect, {block.predicted_seconds, thread_speeds[block.node], block.stealable}});
  }
  return blocks;
}

void CoordinatorState::take_turn(Session& session, FrameInFlight* frame) {
  const bool at_rest = frame->refines.has_value();
  const Accounts::Demand demand{at_rest, at_rest ? session.refinement_cpu_seconds : session.frame_cpu_seconds,
                                1e-6 * static_cast<double>(frame->asked_px)};
  frame->turn = accounts_.begin(session.account, demand, clock_.now());
}

double CoordinatorState::threads_of(const std::vector<AssignedBlock>& blocks) const {
  std::set<NodeId> nodes;
  for (const AssignedBlock& block : blocks) nodes.insert(block.node);
  return nodes_.threads_of(nodes);
}

void CoordinatorState::place(SessionId id, const Session& session, const std::vector<AssignedBlock>& blocks) {
  std::vector<Placement::NodeWork> works;
  works.reserve(blocks.size());
  for (const AssignedBlock& block : blocks) {
    works.push_back({block.node, block.forecast.seconds / speeds_.of(nodes_.at(block.node), session.scene)});
  }
  placement_.planned(id, works, clock_.now());
}

void CoordinatorState::plan(SessionId id, Session& session) {
  FrameInFlight& frame = session.frames.emplace_back();
  frame.id = ++last_frame_;
  const ReceivedView* const next = session.views.send();
  frame.view = next->view;
  frame.received_at = next->received_at;
  frame.turn_began_at = clock_.now();
  frame.last_tile_at = clock_.now();
  frame.asked_px = std::int64_t{frame.view.panorama().width_px()} * frame.view.panorama().height_px();
  if (session.governed) govern(*session.governed, &frame);
  name_light(session.scene, &frame.view);
  take_turn(session, &frame);
  const std::vector<AssignedBlock> blocks = split(id, session, frame.view, frame.view.denoise());
  if (session.costs_known && frame.turn.work == WorkClass::kMoving) place(id, session, blocks);
  const std::uint64_t first_block = last_block_ + 1;
  frame.threads = threads_of(blocks);
  for (const AssignedBlock& block : blocks) {
    frame.assembly.plan(++last_block_, block.node, block.rect, block.forecast);
  }
  frame.last_planned = last_block_;
  frame.planned_at = clock_.now();
  // The fan-out begins here: the first order of a stream is written immediately, on this thread.
  std::uint64_t number = first_block;
  for (const AssignedBlock& block : blocks) order_block(id, session, frame, number++, block.node, block.rect);
}

void CoordinatorState::order_block(SessionId id, const Session& session, const FrameInFlight& frame,
                                   std::uint64_t block, NodeId node_id, const PixelRect& rect) {
  Node& node = nodes_.at(node_id);
  if (node.blocks.empty()) node.worked_at = clock_.now();  // Time spent idle does not count as silence.
  node.blocks[block] = {id, frame.id, session.account, frame.turn.work};
  wire::NodeCommand command;
  wire::RenderBlock* const order = command.mutable_render();
  order->set_block(block);
  order->set_scene(session.scene);
  *order->mutable_view() = frame.view;
  order->set_x_px(static_cast<std::uint32_t>(rect.x));
  order->set_y_px(static_cast<std::uint32_t>(rect.y));
  order->set_width_px(static_cast<std::uint32_t>(rect.width));
  order->set_height_px(static_cast<std::uint32_t>(rect.height));
  order->set_session(static_cast<std::uint64_t>(id));
  order->set_keep(frame.refines.has_value());
  order->set_rank(frame.turn.rank().wire());
  order->set_account(static_cast<std::uint64_t>(session.account));
  order->set_rank_per_cpu_second(frame.threads / (node.threads * accounts_.weight(session.account)));
  order->set_watermark(session.watermark);
  Node::WaitingAccount& own = node.accounts[{session.account, frame.turn.work}];
  ++own.blocks;
  own.stated = std::max(own.stated, accounts_.received(session.account, frame.turn.work));
  state_service(node, session.account, order);
  delegate_.to_node(node_id, command);
}

void CoordinatorState::state_service(Node& node, AccountId except, wire::RenderBlock* order) const {
  const double noticeable = kNoticeable * accounts_.credit();
  for (auto& [name, waiting] : node.accounts) {
    const auto& [account, work] = name;
    const double received = accounts_.received(account, work);
    if (account == except || received - waiting.stated < noticeable) continue;
    if (order->received_size() == kMaxStated) return;
    waiting.stated = received;
    wire::AccountService& service = *order->add_received();
    service.set_account(static_cast<std::uint64_t>(account));
    service.set_rank(Accounts::Turn{work, received, 0.0}.rank().wire());
  }
}

void CoordinatorState::cancel_blocks(const FrameInFlight& frame) {
  for (const auto& [number, block] : frame.assembly.blocks()) {
    const auto node = nodes_.find(block.node);
    if (block.ended || node == nodes_.end() || !node->second.blocks.contains(number)) continue;
    wire::NodeCommand command;
    command.mutable_cancel()->set_block(number);
    delegate_.to_node(block.node, command);
  }
}

void CoordinatorState::fail(FrameInFlight& frame, const std::string& reason, Session& session) {
  if (frame.failure) return;
  frame.failure = reason;
  for (const wire::Tile& tile : frame.held) session.bytes_waiting -= payload_bytes(tile);
  frame.held.clear();
  cancel_blocks(frame);
}

void CoordinatorState::advance(SessionId id) {
  Session& session = sessions_.at(id);
  for (;;) {
    while (!session.frames.empty()) {
      FrameInFlight& frame = session.frames.front();
      if (!frame.begun && !frame.refines) begin(id, session, frame);
      if (!frame.is_over()) break;
      finish(id, session, frame);
      session.frames.pop_front();
    }
    if (session.governed && session.governed->refinement) refine(id, session);
    CHECK(session.views.in_flight() == session.frames.size() + session.unwritten_ends.size());
    if (!session.views.is_sendable()) return;
    if (nodes_with(session.scene) == 0) break;
    plan(id, session);
  }
  const Error reason = unavailable_reason(session.scene);
  forget_session(id);
  delegate_.end_session(id, reason, false);
}

void CoordinatorState::begin(SessionId id, Session& session, FrameInFlight& frame) {
  frame.begun = true;
  frame.foremost_since = clock_.now();
  wire::SessionReply reply;
  *reply.mutable_begin() = frame.view;
  send(id, session, std::move(reply));
  for (wire::Tile& tile : frame.held) relay(id, session, std::move(tile));
  frame.held.clear();
}

void CoordinatorState::relay(SessionId id, Session& session, wire::Tile tile) {
  wire::SessionReply reply;
  *reply.mutable_tile() = std::move(tile);
  send(id, session, std::move(reply));
}

void CoordinatorState::send(SessionId id, Session& session, wire::SessionReply reply) {
  if (session.messages_waiting++ == 0) session.taken_at = clock_.now();
  delegate_.to_museum(id, std::move(reply));
}

FrameReport CoordinatorState::report_of(SessionId id, const FrameInFlight& frame) const {
  const FrameAssembly::Summary sum = frame.assembly.summary();
  FrameReport report{id, sessions_.at(id).museum, !frame.failure, frame.failure.value_or("")};
  for (const auto& [node, cpu_seconds] : sum.loads) {
    const auto found = nodes_.find(node);
    if (found == nodes_.end()) continue;
    report.loads.push_back(cpu_seconds / found->second.threads);
    report.nodes.push_back(node);
  }
  report.received_at = frame.received_at;
  report.queue_seconds = to_seconds(frame.turn_began_at - frame.received_at);
  report.plan_seconds = to_seconds(frame.planned_at - frame.turn_began_at);
  report.fan_out_seconds = to_seconds(std::max(frame.fanned_out_at, frame.planned_at) - frame.planned_at);
  report.rays_seconds = sum.away_seconds;
  report.render_seconds = sum.render_seconds;
  report.encode_seconds = sum.encode_seconds;
  report.farm_seconds = to_seconds(clock_.now() - frame.received_at);
  report.balance_efficiency = balance::balance_efficiency(report.loads);
  report.cpu_seconds = sum.cpu_seconds;
  report.rays = sum.rays;
  report.bytes = frame.bytes;
  report.refined = frame.refines.has_value();
  report.late = frame.late;
  report.reassigned = frame.assembly.was_reassigned();
  report.moved = frame.moved;
  report.view = frame.view;
  if (report.complete && !report.reassigned) report.costs = sum.costs;
  report.samples = static_cast<int>(frame.view.first_sample() + frame.view.samples());
  report.scale = std::sqrt(static_cast<double>(frame.view.panorama().width_px()) * frame.view.panorama().height_px() /
                           static_cast<double>(frame.asked_px));
  return report;
}

void CoordinatorState::finish(SessionId id, Session& session, FrameInFlight& frame) {
  if (!frame.failure) cancel_blocks(frame);  // Cancels stragglers whose tiles other nodes delivered.
  FrameReport report = report_of(id, frame);
  if (session.governed) report.budget_ms = session.governed->governor.budget_ms();
  accounts_.end(session.account, frame.turn);
  // Blocks of a frame that was given up are charged when they end, which is later than this.
  double& predicted = frame.refines ? session.refinement_cpu_seconds : session.frame_cpu_seconds;
  const double cost = frame.failure ? std::max(frame.charged_seconds, predicted) : frame.charged_seconds;
  predicted = std::max(cost, kMinCpuSeconds);
  if (frame.refines) {
    finish_refined(id, session, frame, report);
  } else {
    if (!report.costs.empty()) {
      session.costs_known = true;
      session.balancer->learn({size_of(frame.view), report.costs, frame.view.heading_rad(), eye_of(frame.view),
                               effort_of(frame.view), stacked(frame.view)});
    }
    if (report.complete) {
      session.learn_pace(to_seconds(clock_.now() - frame.foremost_since));
    }
    end(id, session, frame, report);
  }
  delegate_.frame_ended(report);
}

void CoordinatorState::end(SessionId id, Session& session, const FrameInFlight& frame, const FrameReport& report) {
  wire::SessionReply reply;
  wire::FrameEnd* const end = reply.mutable_end();
  end->set_view_number(frame.view.number());
  end->set_tiles(frame.assembly.delivered());
  if (!report.refined) {
    add_stage(end, "queue", report.queue_seconds);
    add_stage(end, "plan", report.plan_seconds);
    add_stage(end, "fan_out", report.fan_out_seconds);
    add_stage(end, "render", report.render_seconds);
    add_stage(end, "encode", report.encode_seconds);
    add_stage(end, "farm", report.farm_seconds);
  }
  end->set_nodes(static_cast<std::uint32_t>(report.loads.size()));
  end->set_balance_efficiency(report.balance_efficiency);
  end->set_complete(report.complete);
  end->set_reason(report.reason);
  end->set_late(report.late);
  end->set_samples(static_cast<std::uint32_t>(report.samples));
  if (session.governed) end->set_reference_samples(static_cast<std::uint32_t>(session.governed->reference_samples));
  session.unwritten_ends.push_back({frame.view.number(), frame.planned_at, frame.last_tile_at,
                                    report.reassigned || (!report.complete && !report.late), frame.work,
                                    rays_ms(report), 1e-6 * static_cast<double>(frame.asked_px),
                                    frame.refines ? frame.refines->end - frame.refines->first : 0});
  send(id, session, std::move(reply));
}

}  // namespace cyclorama::coordinator

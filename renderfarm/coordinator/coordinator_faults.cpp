// SPDX-License-Identifier: Apache-2.0
// Handling of nodes that are slow, silent or gone.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "common/base/text.h"
#include "renderfarm/balance/stealing.h"
#include "renderfarm/coordinator/coordinator_state.h"

namespace cyclorama::coordinator {
namespace {

/// Maximum number of blocks of a node that may get one more by reassignment; a node accepts twice as many
/// (RenderQueue).
constexpr std::size_t kMaxBlocksPerNode = 4096;
/// Number of assignments of a tile after which its frame is given up.
constexpr int kMaxAttempts = 4;
/// A node counts as silent after the longest of three times. This is the first, as a fraction of its session's base
/// time.
constexpr double kSilent = 0.6;
/// The second, as a multiple of the expected time of the node's block.
constexpr double kExpected = 1.5;
/// The third. It is a lower bound, because the system may have been busy for a moment.
constexpr Duration kMinSilenceTimeout = std::chrono::milliseconds(10);
/// Timeout for a picture at rest, which has no budget, as a multiple of the slowest block of the other nodes.
constexpr double kAtRest = 4.0;
/// Minimum timeout for a picture at rest.
constexpr Duration kMinAtRestTimeout = std::chrono::milliseconds(500);
/// Multiple of the base time after which a frame is given up in favour of the next one.
constexpr double kLate = 2.0;
/// Time until a block that was taken from one node is begun by another: a round trip, the work of the coordinator, and
/// a cell of the block that the other node is rendering.
constexpr double kStealSeconds = 0.002;
/// A node counts as slowed if its utilisation is below this fraction of the median of the scene's nodes.
constexpr double kSlowed = 0.5;
/// Minimum time between log lines about a node that is repeatedly late.
constexpr Duration kLateLogPeriod = std::chrono::seconds(10);
/// If a slowed node has not been measured for kForgotten, for lack of blocks, its assumed speed is multiplied by
/// kRecovery: it may have recovered, and the few blocks that it then gets will be measured.
constexpr Duration kForgotten = std::chrono::seconds(1);
constexpr double kRecovery = 1.5;
constexpr double kRemembered = 0.5;

Duration duration_of(double seconds) {
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}

bool is_outstanding(const FrameAssembly::Block& block) { return !block.ended && block.wanted; }

}  // namespace

Duration CoordinatorState::measure_of(const Session& session) {
  const double budget = session.governed ? 1e-3 * session.governed->governor.budget_ms() : 0.0;
  return duration_of(std::max(budget, session.pace_seconds));
}

TimePoint CoordinatorState::due_at(const Session& session, const FrameInFlight& frame,
                                   const FrameAssembly::Block& block) const {
  const auto node = nodes_.find(block.node);
  if (node == nodes_.end()) return TimePoint::max();
  const TimePoint since = std::max(node->second.worked_at, frame.refines ? frame.planned_at : frame.foremost_since);
  if (frame.refines) {
    return since + std::max(kMinAtRestTimeout, duration_of(kAtRest * frame.assembly.summary().render_seconds));
  }
  const double expected =
      session.costs_known ? block.forecast.seconds / wall_speed_of(node->second, session.scene) : 0.0;
  return since + std::max({kMinSilenceTimeout, duration_of(kExpected * expected),
                           duration_of(kSilent * to_seconds(measure_of(session)))});
}

TimePoint CoordinatorState::next_deadline() const {
  const TimePoint now = clock_.now();
  TimePoint next = TimePoint::max();
  for (const auto& [id, session] : sessions_) {
    // A deadline in the past has been handled already, or waits for another event.
    if (session.next_due > now) next = std::min(next, session.next_due);
  }
  return next;
}

TimePoint CoordinatorState::next_due(const Session& session) const {
  TimePoint next = TimePoint::max();
  if (session.frames.empty()) return next;
  const TimePoint now = clock_.now();
  const FrameInFlight& frame = session.frames.front();
  const auto consider = [&](TimePoint at) { next = at > now ? std::min(next, at) : next; };
  for (const auto& [number, block] : frame.assembly.blocks()) {
    if (is_outstanding(block)) consider(due_at(session, frame, block));
  }
  if (frame.begun && !frame.refines)
    consider(frame.foremost_since + duration_of(kLate * to_seconds(measure_of(session))));
  return next;
}

void CoordinatorState::watch(SessionId id) {
  meet_deadlines(id);
  const auto found = sessions_.find(id);
  if (found != sessions_.end()) found->second.next_due = next_due(found->second);
}

void CoordinatorState::meet_deadlines(SessionId id) {
  const auto found = sessions_.find(id);
  if (found == sessions_.end() || found->second.frames.empty()) return;
  Session& session = found->second;
  FrameInFlight& frame = session.frames.front();
  if (!frame.begun && !frame.refines) return;
  const double taken = to_seconds(clock_.now() - frame.foremost_since);
  const bool has_successor = session.views.is_waiting() || session.frames.size() > 1;
  if (!frame.refines && has_successor && taken >= kLate * to_seconds(measure_of(session))) {
    session.miss_pace();
    frame.late = true;
    fail(frame,
         fmt::format("late: incomplete after {:.0f} ms; the last complete picture stands in for it", 1e3 * taken),
         session);
    for (const NodeId node : silent_nodes(session, frame)) retire(node, session.account);
    return advance(id);
  }
  for (const NodeId node : silent_nodes(session, frame)) retire(node, session.account);
}

bool CoordinatorState::has_idle_node(const Session& session, const FrameInFlight& frame) const {
  return std::ranges::any_of(nodes_for(session, frame.view.light()), [&](NodeId node) {
    return !nodes_.at(node).is_late(session.account) &&
           std::ranges::none_of(frame.assembly.blocks(), [&](const auto& entry) {
             return entry.second.node == node && is_outstanding(entry.second);
           });
  });
}

std::vector<NodeId> CoordinatorState::silent_nodes(const Session& session, const FrameInFlight& frame) const {
  std::set<NodeId> silent;
  if (!has_idle_node(session, frame)) return {};
  for (const auto& [number, block] : frame.assembly.blocks()) {
    const auto node = nodes_.find(block.node);
    if (node == nodes_.end() || node->second.is_late(session.account) || !is_outstanding(block)) continue;
    if (clock_.now() >= due_at(session, frame, block)) silent.insert(block.node);
  }
  return {silent.begin(), silent.end()};
}

void CoordinatorState::retire(NodeId id, AccountId account) {
  Node& node = nodes_.at(id);
  if (node.is_late(account)) return;
  node.late_for.insert(account);
  log_late_node(node);
  std::map<std::uint64_t, BlockLocation> blocks = node.blocks;  // Copied, because reassigning orders new blocks.
  std::erase_if(blocks, [&](const auto& entry) { return !node.is_late(entry.second.account); });
  for (const auto& [block, place] : blocks) {
    FrameInFlight* const frame = find_frame(place);
    if (frame != nullptr && !frame->failure) frame->assembly.forgive_attempt(block);
  }
  lose_blocks(blocks, id);
}

void CoordinatorState::log_late_node(Node& node) {
  const TimePoint now = clock_.now();
  if (node.late_logged_at && now - *node.late_logged_at < kLateLogPeriod) {
    ++node.late_unlogged;
    return;
  }
  node.late_logged_at = now;
  const int untold = std::exchange(node.late_unlogged, 0);
  const std::string more = untold == 0 ? "" : fmt::format(" ({} times more since it was last said)", untold);
  delegate_.notice(fmt::format("node '{}' keeps a frame waiting; others take over{}", printable(node.name), more),
                   {.node = node.name, .is_trouble = true});
}

void CoordinatorState::lose_blocks(const std::map<std::uint64_t, BlockLocation>& blocks, NodeId not_to) {
  std::map<std::pair<SessionId, std::uint64_t>, std::vector<PixelRect>> orphans;
  for (const auto& [block, place] : blocks) {
    FrameInFlight* const frame = find_frame(place);
    if (frame == nullptr || frame->failure) continue;
    std::vector<PixelRect>& tiles = orphans[{place.session, place.frame}];
    for (const PixelRect& tile : frame->assembly.give_up(block)) tiles.push_back(tile);
  }
  std::set<SessionId> touched;
  for (auto& [place, tiles] : orphans) {
    FrameInFlight* const frame = find_frame({place.first, place.second});
    reassign(place.first, sessions_.at(place.first), *frame, std::move(tiles), not_to);
    touched.insert(place.first);
  }
  for (const SessionId id : touched) advance(id);
}

void CoordinatorState::reassign(SessionId id, Session& session, FrameInFlight& frame, std::vector<PixelRect> tiles,
                                NodeId not_to) {
  if (tiles.empty()) return;
  const std::vector<NodeId> nodes = nodes_for(session, frame.view.light(), not_to);
  if (nodes.empty()) return fail(frame, "no node is left that can render it", session);
  const auto busy = [&](NodeId node) {
    return std::ranges::any_of(frame.assembly.blocks(), [&](const auto& entry) {
      return entry.second.node == node && is_outstanding(entry.second);
    });
  };
  const auto idle = static_cast<std::size_t>(std::ranges::count_if(nodes, [&](NodeId node) { return !busy(node); }));
  // Tiles are cut so that all idle nodes help. A picture at rest keeps its tiles, since its sums are stored per tile.
  if (!frame.refines && idle > tiles.size()) {
    std::vector<PixelRect> parts;
    for (const PixelRect& tile : tiles) {
      for (const PixelRect& part : frame.assembly.cut(tile, idle / tiles.size())) parts.push_back(part);
    }
    tiles = std::move(parts);
  }
  for (const PixelRect& tile : tiles) {
    if (frame.assembly.attempts(tile) >= kMaxAttempts) {
      return fail(frame, fmt::format("{} nodes failed at the same tile", kMaxAttempts), session);
    }
    const NodeId node = least_loaded(nodes);
    if (nodes_.at(node).blocks.size() >= kMaxBlocksPerNode) {
      return fail(frame, "too many blocks wait for the nodes that are left", session);
    }
    frame.assembly.replan(++last_block_, node, tile);
    order_block(id, session, frame, last_block_, node, tile);
  }
}

void CoordinatorState::move_block_to_idle(SessionId id, Session& session, FrameInFlight& frame, NodeId idle) {
  if (frame.refines || frame.failure) return;
  std::vector<NodeId> nodes;
  std::vector<balance::NodeQueue> queues;
  std::vector<std::vector<std::uint64_t>> numbers;
  const auto index_of = [&](NodeId id_of) {
    const auto found = std::ranges::find(nodes, id_of);
    if (found != nodes.end()) return static_cast<std::size_t>(found - nodes.begin());
    const Node& node = nodes_.at(id_of);
    nodes.push_back(id_of);
    queues.push_back({wall_speed_of(node, session.scene), {}, to_seconds(clock_.now() - node.worked_at)});
    numbers.emplace_back();
    return nodes.size() - 1;
  };
  const std::size_t taker = index_of(idle);
  for (const auto& [number, block] : frame.assembly.blocks()) {
    if (!is_outstanding(block) || !nodes_.contains(block.node)) continue;
    if (block.node == idle) return;
    const std::size_t i = index_of(block.node);
    queues[i].blocks.push_back({block.forecast.seconds, block.forecast.stealable && block.delivered == 0});
    numbers[i].push_back(number);
  }
  const Node& taking = nodes_.at(idle);
  if (taking.is_late(session.account) || taking.status.draining()) return;
  const auto steal = balance::choose_steal(queues, taker, kStealSeconds);
  if (!steal) return;
  const std::uint64_t from = numbers[steal->from][steal->block];
  frame.assembly.move(from, ++last_block_, idle, taking.scenes.at(session.scene).speed);
  ++frame.moved;
  wire::NodeCommand cancel;
  cancel.mutable_cancel()->set_block(from);
  delegate_.to_node(nodes[steal->from], cancel);
  order_block(id, session, frame, last_block_, idle, frame.assembly.blocks().at(last_block_).rect);
}

void CoordinatorState::learn_utilisation(Node& node, const wire::BlockEnd& end) {
  constexpr double kKept = 0.9;
  constexpr double kMaxSeconds = 1e6;
  const double possible = end.wall_seconds() * node.threads;
  const double used = end.render_cpu_seconds();
  if (!(possible > 0.0 && possible < kMaxSeconds && used >= 0.0 && used < kMaxSeconds)) return;
  // The utilisation is that of the total time, not the mean of the blocks, because most blocks of a node that stalls
  // now and then are as fast as usual.
  node.used_seconds = kKept * node.used_seconds + used;
  node.possible_seconds = kKept * node.possible_seconds + possible;
  node.utilisation = std::clamp(node.used_seconds / node.possible_seconds, 0.01, 1.0);
  node.measured_at = clock_.now();
}

void CoordinatorState::compare_nodes() {
  for (const FarmScene& scene : scenes_) {
    std::vector<double> utilisations;
    for (const auto& [id, node] : nodes_) {
      if (node.has(scene.name)) utilisations.push_back(node.utilisation);
    }
    const auto middle = utilisations.begin() + static_cast<std::ptrdiff_t>(utilisations.size() / 2);
    std::ranges::nth_element(utilisations, middle);
    const double usual = usual_utilisation_[scene.name] = utilisations.empty() ? 1.0 : *middle;
    for (auto& [id, node] : nodes_) {
      const bool is_slowed = node.has(scene.name) && node.utilisation < kSlowed * usual;
      if (!is_slowed || clock_.now() - node.measured_at < kForgotten) continue;
      node.utilisation *= kRecovery;
      node.possible_seconds *= kRemembered;  // Gives new measurements more weight than old ones.
      node.used_seconds = node.utilisation * node.possible_seconds;
      node.measured_at = clock_.now();
    }
  }
}

double CoordinatorState::speed_of(const Node& node, const std::string& scene) const {
  // Small blocks on many threads, and shared hosts, make all nodes wait. Therefore only a node that waits far more than
  // the others counts as slowed.
  const auto usual = usual_utilisation_.find(scene);
  const double slowed = usual == usual_utilisation_.end() ? 1.0 : node.utilisation / usual->second;
  const auto known = node.scenes.find(scene);
  return node.threads * (known == node.scenes.end() ? 1.0 : known->second.speed) * (slowed < kSlowed ? slowed : 1.0);
}

double CoordinatorState::wall_speed_of(const Node& node, const std::string& scene) const {
  const auto usual = usual_utilisation_.find(scene);
  return speed_of(node, scene) * (usual == usual_utilisation_.end() ? 1.0 : usual->second);
}

}  // namespace cyclorama::coordinator

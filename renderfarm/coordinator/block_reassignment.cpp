// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/block_reassignment.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "renderfarm/balance/stealing.h"

namespace cyclorama::coordinator {
namespace {

/// Maximum number of blocks of a node that may get one more by reassignment; a node accepts twice as many
/// (RenderQueue).
constexpr std::size_t kMaxBlocksPerNode = 4096;
/// Number of assignments of a tile after which its frame is given up.
constexpr int kMaxAttempts = 4;
/// Time until a block that was taken from a node is begun by another: a round trip, the coordinator's turn, and a cell
/// of whatever the other renders.
constexpr double kStealSeconds = 0.002;
/// Minimum time between log lines about a node that is late repeatedly.
constexpr Duration kLateLogPeriod = std::chrono::seconds(10);

}  // namespace

std::set<SessionId> BlockReassignment::retire(NodeId id, AccountId account) {
  Node& node = nodes_.at(id);
  if (node.is_late(account)) return {};
  node.late_for.insert(account);
  log_late(node);
  std::map<std::uint64_t, BlockLocation> blocks = node.blocks;  // Copied, because reassigning orders new blocks.
  std::erase_if(blocks, [&](const auto& entry) { return !node.is_late(entry.second.account); });
  for (const auto& [block, place] : blocks) {
    FrameInFlight* const frame = sessions_.find_frame(place);
    if (frame != nullptr && !frame->failure) frame->assembly.forgive_attempt(block);
  }
  return lose(blocks, id);
}

void BlockReassignment::log_late(Node& node) {
  const TimePoint now = clock_.now();
  if (node.late_logged_at && now - *node.late_logged_at < kLateLogPeriod) {
    ++node.late_unlogged;
    return;
  }
  node.late_logged_at = now;
  const int untold = std::exchange(node.late_unlogged, 0);
  const std::string more = untold == 0 ? "" : fmt::format(" ({} times more since it was last said)", untold);
  delegate_.notice(fmt::format("{} keeps a frame waiting; others take over{}", title_of(node), more),
                   {.node = node.name, .is_trouble = true});
}

std::set<SessionId> BlockReassignment::lose(const std::map<std::uint64_t, BlockLocation>& blocks, NodeId not_to) {
  std::map<std::pair<SessionId, std::uint64_t>, std::vector<PixelRect>> orphans;
  for (const auto& [block, place] : blocks) {
    FrameInFlight* const frame = sessions_.find_frame(place);
    if (frame == nullptr || frame->failure) continue;
    std::vector<PixelRect>& tiles = orphans[{place.session, place.frame}];
    for (const PixelRect& tile : frame->assembly.give_up(block)) tiles.push_back(tile);
  }
  std::set<SessionId> touched;
  for (auto& [place, tiles] : orphans) {
    FrameInFlight* const frame = sessions_.find_frame({place.first, place.second});
    reassign(place.first, sessions_.at(place.first), *frame, std::move(tiles), not_to);
    touched.insert(place.first);
  }
  return touched;
}

void BlockReassignment::reassign(SessionId id, Session& session, FrameInFlight& frame, std::vector<PixelRect> tiles,
                                 NodeId not_to) {
  if (tiles.empty()) return;
  const std::vector<NodeId> nodes = nodes_.able(session.scene, session.account, frame.view.light(), not_to);
  if (nodes.empty()) return orders_.give_up(frame, "no node is left that can render it", session);
  const auto is_idle = [&](NodeId node) { return !frame.assembly.waits_for(node); };
  const auto idle = static_cast<std::size_t>(std::ranges::count_if(nodes, is_idle));
  // Cut tiles so that all idle nodes help. A picture at rest keeps its tiles, since its sums are stored per tile.
  if (!frame.refines && idle > tiles.size()) {
    std::vector<PixelRect> parts;
    for (const PixelRect& tile : tiles) {
      for (const PixelRect& part : frame.assembly.cut(tile, idle / tiles.size())) parts.push_back(part);
    }
    tiles = std::move(parts);
  }
  for (const PixelRect& tile : tiles) {
    if (frame.assembly.attempts(tile) >= kMaxAttempts) {
      return orders_.give_up(frame, fmt::format("{} nodes failed at the same tile", kMaxAttempts), session);
    }
    const NodeId node = nodes_.least_loaded(nodes);
    if (nodes_.at(node).blocks.size() >= kMaxBlocksPerNode) {
      return orders_.give_up(frame, "too many blocks wait for the nodes that are left", session);
    }
    const std::uint64_t number = orders_.next_number();
    frame.assembly.replan(number, node, tile);
    orders_.order(id, session, frame, number, node, tile);
  }
}

void BlockReassignment::move_block_to_idle(SessionId id, Session& session, FrameInFlight& frame, NodeId idle) {
  if (frame.refines || frame.failure || frame.assembly.waits_for(idle)) return;
  const TimePoint now = clock_.now();
  std::vector<NodeId> nodes;
  std::vector<balance::NodeQueue> queues;
  const auto add = [&](NodeId id_of) -> balance::NodeQueue& {
    const Node& node = nodes_.at(id_of);
    nodes.push_back(id_of);
    return queues.emplace_back(
        balance::NodeQueue{speeds_.wall_speed_of(node, session.scene), {}, to_seconds(now - node.worked_at)});
  };
  add(idle);
  for (const auto& [owing, numbers] : frame.assembly.outstanding()) {
    // The block that a node works on cannot be moved.
    if (numbers.size() < 2 || !nodes_.contains(owing)) continue;
    balance::NodeQueue& queue = add(owing);
    for (const std::uint64_t number : numbers) {
      const FrameAssembly::Block& block = frame.assembly.blocks().at(number);
      queue.blocks.push_back({block.forecast.seconds, block.forecast.stealable && block.delivered == 0});
    }
  }
  const Node& taking = nodes_.at(idle);
  if (taking.is_late(session.account) || taking.status.draining()) return;
  const auto steal = balance::choose_steal(queues, 0, kStealSeconds);
  if (!steal) return;
  const std::uint64_t from = frame.assembly.outstanding().at(nodes[steal->from])[steal->block];
  const std::uint64_t number = orders_.next_number();
  frame.assembly.move(from, number, idle, taking.scenes.at(session.scene).speed);
  ++frame.moved;
  orders_.cancel(nodes[steal->from], from);
  orders_.order(id, session, frame, number, idle, frame.assembly.blocks().at(number).rect);
}

}  // namespace cyclorama::coordinator

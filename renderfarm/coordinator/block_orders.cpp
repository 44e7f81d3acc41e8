// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/block_orders.h"

#include <algorithm>

#include "common/wire/payload.h"

namespace cyclorama::coordinator {
namespace {

/// Fraction of the credit by which an account's service must differ from the value last stated to a node before it is
/// stated again.
constexpr double kNoticeable = 0.1;
/// Maximum accounts that one order states.
constexpr int kMaxStated = 16;

}  // namespace

void BlockOrders::order(SessionId id, Session& session, const FrameInFlight& frame, std::uint64_t block, NodeId node_id,
                        const PixelRect& rect) {
  Node& node = nodes_.at(node_id);
  session.due.earliest = TimePoint::min();
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

void BlockOrders::state_service(Node& node, AccountId except, wire::RenderBlock* order) const {
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

void BlockOrders::cancel(NodeId node, std::uint64_t block) {
  wire::NodeCommand command;
  command.mutable_cancel()->set_block(block);
  delegate_.to_node(node, command);
}

void BlockOrders::cancel(const FrameInFlight& frame) {
  for (const auto& [number, block] : frame.assembly.blocks()) {
    const auto node = nodes_.find(block.node);
    if (block.ended || node == nodes_.end() || !node->second.blocks.contains(number)) continue;
    cancel(block.node, number);
  }
}

void BlockOrders::give_up(FrameInFlight& frame, const std::string& reason, Session& session) {
  if (frame.failure) return;
  frame.failure = reason;
  for (const wire::Tile& tile : frame.held) session.bytes_waiting -= payload_bytes(tile);
  frame.held.clear();
  cancel(frame);
}

std::optional<BlockLocation> BlockOrders::end(Node& node, const wire::BlockEnd& end) {
  const auto found = node.blocks.find(end.block());
  if (found == node.blocks.end()) return std::nullopt;
  BlockLocation place = found->second;
  node.blocks.erase(found);
  const auto account = node.accounts.find({place.account, place.work});
  if (--account->second.blocks == 0) node.accounts.erase(account);
  charge(&place,
         measured_seconds(end.render_cpu_seconds()) + measured_seconds(end.encode_cpu_seconds()) + kOverheadSeconds);
  return place;
}

bool BlockOrders::progress(Node& node, const wire::BlockProgress& progress) {
  const auto found = node.blocks.find(progress.block());
  if (found == node.blocks.end()) return false;
  charge(&found->second, measured_seconds(progress.render_cpu_seconds()));
  return true;
}

void BlockOrders::charge(BlockLocation* place, double cpu_seconds) {
  const double more = cpu_seconds - place->charged_seconds;
  if (!(more > 0.0)) return;
  place->charged_seconds = cpu_seconds;
  accounts_.charge(place->account, place->work, more, clock_.now());
  if (FrameInFlight* const frame = sessions_.find_frame(*place)) frame->charged_seconds += more;
}

}  // namespace cyclorama::coordinator

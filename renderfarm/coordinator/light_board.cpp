// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/light_board.h"

#include <algorithm>
#include <utility>

#include "renderfarm/scene_distribution/sha256.h"

namespace cyclorama::coordinator {
namespace {

constexpr std::uint32_t kMaxPieces = 256;  ///< Equals light_baking::kMaxPieces.
constexpr std::uint32_t kMaxStages = 10'000;
constexpr std::size_t kKeyDigits = 32;
constexpr std::uint64_t kMaxPieceBytes = std::uint64_t{1} << 30;

Status check(const wire::LightPieces& report) {
  const wire::LightStage& stage = report.stage();
  const bool is_key =
      stage.key().size() == kKeyDigits && stage.key().find_first_not_of("0123456789abcdef") == std::string::npos;
  bool is_sound = is_key && stage.number() < kMaxStages && stage.pieces() >= 1 && stage.pieces() <= kMaxPieces;
  for (const wire::LightPiece& piece : report.pieces()) {
    is_sound &= piece.piece() < stage.pieces() && scene_distribution::is_sha256(piece.file().version()) &&
                piece.file().bytes() <= kMaxPieceBytes;
  }
  if (is_sound) return Done{};
  return Error(ErrorCode::kInvalidArgument, "it reports pieces of light that there cannot be");
}

wire::LightPieceOrder order_of(const wire::LightStage& stage, std::uint32_t piece, const wire::LightVersion& file) {
  wire::LightPieceOrder order;
  *order.mutable_stage() = stage;
  order.mutable_piece()->set_piece(piece);
  *order.mutable_piece()->mutable_file() = file;
  return order;
}

}  // namespace

std::optional<NodeId> LightBoard::sender_of(const Piece& piece) {
  const auto found = std::ranges::find_if(piece.holders, [&](NodeId holder) { return !piece.silent.contains(holder); });
  return found == piece.holders.end() ? std::nullopt : std::optional(*found);
}

bool LightBoard::must_compute(const Piece& piece, NodeId node) {
  return !piece.holders.contains(node) && !piece.is_here && !piece.sending && !sender_of(piece);
}

Result<bool> LightBoard::report(NodeId node, const wire::LightPieces& report) {
  TRY(check(report));
  const std::uint32_t number = report.stage().number();
  const auto known = stages_.find(number);
  const bool is_other = known != stages_.end() && (known->second.stage.key() != report.stage().key() ||
                                                   known->second.stage.pieces() != report.stage().pieces());
  const bool is_alone = at_.empty() || (at_.size() == 1 && at_.contains(node));
  if (known == stages_.end() || (is_other && is_alone)) {
    if (is_other) erase_from(number);
    stages_[number] = {report.stage(), std::vector<Piece>(report.stage().pieces())};
  } else if (is_other) {
    leave(node);
    return false;
  }
  at_[node] = number;
  Stage& stage = stages_.at(number);
  for (const wire::LightPiece& taken : report.pieces()) {
    Piece& piece = stage.pieces[taken.piece()];
    if (piece.file.version().empty()) piece.file = taken.file();
    piece.working.reset();
    // Its own results are others only if it computes wrongly; then its next stage has another key.
    if (piece.file.version() == taken.file().version()) piece.holders.insert(node);
  }
  return true;
}

void LightBoard::forget_file(Piece* piece) {
  if (!piece->is_here && !piece->sending) return;
  piece->is_here = false;
  piece->sending.reset();
  piece->given.clear();
  --files_;
  unneeded_.push_back(piece->file);
}

void LightBoard::erase_from(std::uint32_t number) {
  for (auto stage = stages_.lower_bound(number); stage != stages_.end(); stage = stages_.erase(stage)) {
    for (Piece& piece : stage->second.pieces) forget_file(&piece);
  }
}

void LightBoard::leave(NodeId node) {
  at_.erase(node);
  for (auto& [number, stage] : stages_) {
    for (Piece& piece : stage.pieces) {
      piece.holders.erase(node);
      piece.silent.erase(node);
      piece.given.erase(node);
      if (piece.working && piece.working->node == node) piece.working.reset();
      if (piece.sending && piece.sending->node == node) forget_file(&piece);
      if (piece.holders.empty() && !piece.is_here) piece.file.Clear();
    }
  }
}

void LightBoard::stored(const std::string& sha256) {
  for (auto& [number, stage] : stages_) {
    for (Piece& piece : stage.pieces) {
      if (piece.is_here || !piece.sending || piece.file.version() != sha256) continue;
      piece.sending.reset();
      piece.silent.clear();
      piece.is_here = true;
    }
  }
}

LightBoard::Orders LightBoard::next(TimePoint now, const std::function<bool(NodeId)>& is_idle) {
  Orders orders;
  drop_unneeded();
  orders.unneeded = std::exchange(unneeded_, {});
  for (const auto& [node, number] : at_) give_out(stages_.at(number), node, now, &orders);
  order_pieces(now, is_idle, &orders);
  return orders;
}

void LightBoard::drop_unneeded() {
  for (auto& entry : stages_) {
    const auto number = entry.first;
    for (Piece& piece : entry.second.pieces) {
      if (!piece.is_here) continue;
      const bool is_needed = std::ranges::any_of(
          at_, [&](const auto& at) { return at.second == number && !piece.holders.contains(at.first); });
      // If all nodes that had it are gone, this is the only copy for those that come back.
      if (!is_needed && !piece.holders.empty()) forget_file(&piece);
    }
  }
}

void LightBoard::give_out(Stage& stage, NodeId node, TimePoint now, Orders* orders) {
  for (std::uint32_t i = 0; i < stage.pieces.size(); ++i) {
    Piece& piece = stage.pieces[i];
    if (piece.file.version().empty() || piece.holders.contains(node)) continue;
    const wire::LightPieceOrder order = order_of(stage.stage, i, piece.file);
    if (piece.is_here) {
      const auto given = piece.given.find(node);
      if (given != piece.given.end() && now - given->second < kTransferTimeout) continue;
      piece.given[node] = now;
      orders->use.emplace_back(node, order);
      continue;
    }
    if (piece.sending && now - piece.sending->ordered_at < kTransferTimeout) continue;
    if (piece.sending) {
      piece.silent.insert(piece.sending->node);
      forget_file(&piece);
    }
    const std::optional<NodeId> sender = sender_of(piece);
    if (!sender || files_ >= kMaxFiles) continue;
    ++files_;
    piece.sending = {*sender, now};
    orders->send.emplace_back(*sender, order);
  }
}

void LightBoard::order_pieces(TimePoint now, const std::function<bool(NodeId)>& is_idle, Orders* orders) {
  for (const auto& at : at_) {
    const NodeId node = at.first;
    const auto number = at.second;
    if (!is_idle(node)) continue;
    Stage& stage = stages_.at(number);
    auto working = static_cast<std::size_t>(std::ranges::count_if(
        stage.pieces, [&](const Piece& piece) { return piece.working && piece.working->node == node; }));
    const auto others =
        static_cast<std::size_t>(std::ranges::count_if(at_, [&](const auto& entry) { return entry.second == number; }));
    const auto open = static_cast<std::size_t>(
        std::ranges::count_if(stage.pieces, [&](const Piece& piece) { return must_compute(piece, node); }));
    // Towards the end of a stage each gets its share only, so that none waits for another.
    const std::size_t limit = std::min(kOrdered, (open + others - 1) / others);
    for (std::uint32_t i = 0; i < stage.pieces.size(); ++i) {
      Piece& piece = stage.pieces[i];
      if (!must_compute(piece, node)) continue;
      if (piece.working && now - piece.working->ordered_at < kPieceTimeout) continue;
      const bool is_repeated = piece.working && piece.working->node == node;  // The order may have been lost.
      if (!is_repeated && working >= limit) continue;
      if (!is_repeated) ++working;
      piece.working = {node, now};
      wire::ComputePieces& order = orders->compute[node];
      *order.mutable_stage() = stage.stage;
      order.add_pieces(i);
    }
  }
}

std::vector<wire::LightVersion> LightBoard::clear() {
  erase_from(0);
  at_.clear();
  return std::exchange(unneeded_, {});
}

}  // namespace cyclorama::coordinator

// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/ordered_pieces.h"

#include <fmt/format.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <sstream>

#include "common/base/file.h"
#include "renderfarm/node/light_versions.h"

namespace cyclorama::node {

using light_baking::LightStage;
using light_baking::PieceBytes;
using light_baking::StageWork;

Status OrderedPieces::begin(const std::string& computation) {
  folder_.begin(computation);
  return Done{};
}

Result<std::vector<OrderedPieces::Order>> OrderedPieces::next_orders() const {
  std::vector<Order> orders;
  for (;;) {
    std::array<char, 64> text{};
    const ssize_t n = ::recv(orders_, text.data(), text.size(), orders.empty() ? 0 : MSG_DONTWAIT);
    if (n < 0 && errno == EINTR) continue;
    if (n == 0) return Error(ErrorCode::kUnavailable, "the node that computed light has ended");
    if (n < 0 && !orders.empty()) return orders;
    if (n < 0) return Error::from_errno("waiting for orders of the node");
    std::istringstream words(std::string(text.data(), static_cast<std::size_t>(n)));
    std::string verb;
    Order order;
    if (words >> verb >> order.stage >> order.piece) {
      order.is_fetched = verb == "fetched";
      orders.push_back(order);
    }
  }
}

bool OrderedPieces::take_kept(const LightStage& stage, const StageWork& work, std::uint32_t piece) const {
  const auto kept = folder_.load(stage, piece);
  return kept && work.take(piece, *kept);
}

Status OrderedPieces::report(const LightStage& stage, std::uint32_t piece) const {
  TRY_ASSIGN(const MappedFile file, MappedFile::open(folder_.file_of(stage.number, piece)));
  report_(fmt::format("piece {} {} {} {}", stage.number, piece, version_of(file.bytes()), file.bytes().size()));
  return Done{};
}

Status OrderedPieces::complete(const LightStage& stage, const StageWork& work) {
  report_(fmt::format("stage {} {} {} {}", stage.number, stage.key, stage.pieces,
                      folder_.file_of(stage.number, 0).parent_path().string()));
  std::vector<std::uint8_t> is_taken(stage.pieces, 0);
  std::uint32_t left = stage.pieces;
  const auto note_taken = [&](std::uint32_t piece) {
    is_taken[piece] = 1;
    --left;
  };
  for (std::uint32_t piece = 0; piece < stage.pieces; ++piece) {
    if (!take_kept(stage, work, piece)) continue;
    note_taken(piece);
    TRY(report(stage, piece));
  }
  while (left > 0) {
    TRY_ASSIGN(const std::vector<Order> orders, next_orders());
    std::vector<std::uint32_t> ordered;
    for (const Order& order : orders) {
      if (order.stage != stage.number || order.piece >= stage.pieces) continue;
      if (is_taken[order.piece] != 0) {  // A report may have been lost with a coordinator.
        TRY(report(stage, order.piece));
        continue;
      }
      if (!order.is_fetched) {
        if (std::ranges::find(ordered, order.piece) == ordered.end()) ordered.push_back(order.piece);
      } else if (take_kept(stage, work, order.piece)) {
        note_taken(order.piece);
        std::erase(ordered, order.piece);
        TRY(report(stage, order.piece));
      }
    }
    const auto compute = [&](std::uint32_t piece) -> Status {
      TRY_ASSIGN(const PieceBytes bytes, work.compute(piece));
      TRY(folder_.save(stage, piece, bytes));
      TRY(work.take(piece, bytes));
      return report(stage, piece);
    };
    TRY(light_baking::for_pieces(ordered, work.in_parallel, compute));
    for (const std::uint32_t piece : ordered) note_taken(piece);
  }
  return Done{};
}

}  // namespace cyclorama::node

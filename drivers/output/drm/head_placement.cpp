// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/head_placement.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/check.h"
#include "common/base/text.h"

namespace cyclorama {
namespace {

bool fits(const SocketWish& wish, const Socket& socket) {
  return (!wish.card || *wish.card == socket.card) && wish.connector == socket.connector;
}

}  // namespace

Result<SocketWish> parse_socket(std::string_view text) {
  constexpr long long kMostCards = 16;
  SocketWish wish;
  std::string_view connector = text;
  if (const std::size_t colon = text.find(':'); colon != std::string_view::npos) {
    const auto card = parse_integer(text.substr(0, colon));
    connector = text.substr(colon + 1);
    if (!card || *card < 0 || *card >= kMostCards || connector.empty()) {
      return Error(
          ErrorCode::kInvalidArgument,
          fmt::format("'{}' names no connector; write HDMI-A-1, or 1:HDMI-A-1 for the second card", printable(text)));
    }
    wish.card = static_cast<std::size_t>(*card);
  }
  wish.connector = connector;
  return wish;
}

std::vector<std::optional<Socket>> place_heads(std::span<const SocketWish> wishes, std::span<const SeenSocket> seen,
                                               std::span<const std::optional<Socket>> before) {
  CHECK(before.empty() || before.size() == wishes.size());
  std::vector<std::optional<Socket>> placed(before.begin(), before.end());
  placed.resize(wishes.size());
  const auto is_taken = [&](const Socket& socket) {
    return std::find(placed.begin(), placed.end(), socket) != placed.end();
  };
  const auto first_free = [&](auto is_fit) -> std::optional<Socket> {
    const auto found =
        std::find_if(seen.begin(), seen.end(), [&](const SeenSocket& s) { return is_fit(s) && !is_taken(s.socket); });
    return found == seen.end() ? std::nullopt : std::optional(found->socket);
  };
  for (std::size_t i = 0; i < wishes.size(); ++i) {
    if (!placed[i] && !wishes[i].connector.empty())
      placed[i] = first_free([&](const SeenSocket& s) { return fits(wishes[i], s.socket); });
  }
  const auto is_wished = [&](const Socket& socket) {
    return std::any_of(wishes.begin(), wishes.end(), [&](const SocketWish& w) { return fits(w, socket); });
  };
  for (std::size_t i = 0; i < wishes.size(); ++i) {
    if (!placed[i] && wishes[i].connector.empty())
      placed[i] = first_free([&](const SeenSocket& s) { return s.is_connected && !is_wished(s.socket); });
  }
  return placed;
}

}  // namespace cyclorama

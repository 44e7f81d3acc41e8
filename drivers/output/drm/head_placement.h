// SPDX-License-Identifier: Apache-2.0
/// Which head belongs on which connector. Pure.
#pragma once

#include <compare>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"

namespace cyclorama {

/// A connector of one of several cards.
struct Socket {
  std::size_t card = 0;
  std::string connector{};  ///< "HDMI-A-1".
  friend auto operator<=>(const Socket&, const Socket&) = default;
};

/// What the installation says of a head's place: nothing, a connector on the first card that has it, or on that one.
struct SocketWish {
  std::optional<std::size_t> card{};
  std::string connector{};  ///< Empty: any.
};
/// "", "HDMI-A-1" or "1:HDMI-A-1", cards counted from 0. kInvalidArgument  another form.
Result<SocketWish> parse_socket(std::string_view text);

struct SeenSocket {
  Socket socket;
  bool is_connected = false;
};

/// The socket of each head, or nothing as long as none is known for it. `seen` in the cards' order. A head stays where
/// it is in `before` (empty at first) for ever, so that a projector that is switched off and on, or swapped, gets the
/// same picture again. Heads without a wish take, in order, what is connected and nobody else's.
/// Precondition: before is empty or as long as wishes.
[[nodiscard]] std::vector<std::optional<Socket>> place_heads(std::span<const SocketWish> wishes,
                                                             std::span<const SeenSocket> seen,
                                                             std::span<const std::optional<Socket>> before);

}  // namespace cyclorama

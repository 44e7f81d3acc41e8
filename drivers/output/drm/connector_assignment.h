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

namespace cyclorama::output {

/// A connector of one of several cards.
struct ConnectorId {
  std::size_t card = 0;
  std::string connector{};  ///< "HDMI-A-1".
  friend auto operator<=>(const ConnectorId&, const ConnectorId&) = default;
};

/// What the installation says of a head's place: nothing, a connector on the first card that has it, or on that one.
struct ConnectorPreference {
  std::optional<std::size_t> card{};
  std::string connector{};  ///< Empty: any.
};
/// "", "HDMI-A-1" or "1:HDMI-A-1", cards counted from 0. kInvalidArgument  another form.
Result<ConnectorPreference> parse_connector_preference(std::string_view text);

struct AvailableConnector {
  ConnectorId socket;
  bool is_connected = false;
};

/// The socket of each head, or nothing as long as none is known for it. `seen` in the cards' order. A head stays where
/// it is in `before` (empty at first) for ever, so that a projector that is switched off and on, or swapped, gets the
/// same picture again. Heads without a preferred take, in order, what is connected and nobody else's.
/// Precondition: before is empty or as long as preferences.
[[nodiscard]] std::vector<std::optional<ConnectorId>> assign_connectors(
    std::span<const ConnectorPreference> preferences, std::span<const AvailableConnector> seen,
    std::span<const std::optional<ConnectorId>> before);

}  // namespace cyclorama::output

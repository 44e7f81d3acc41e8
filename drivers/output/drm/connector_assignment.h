// SPDX-License-Identifier: Apache-2.0
/// Assignment of heads to connectors. Pure.
#pragma once

#include <compare>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::output {

/// A connector, identified among several cards.
struct ConnectorId {
  std::size_t card = 0;
  std::string connector{};  ///< "HDMI-A-1".
  friend auto operator<=>(const ConnectorId&, const ConnectorId&) = default;
};

/// Connector that the installation requests for a head: any, a name on the first card that has it, or a name on one
/// card.
struct ConnectorPreference {
  std::optional<std::size_t> card{};
  std::string connector{};  ///< Empty: any.
  std::string serial{};     ///< Serial of the projector, on any connector; empty: any projector.
};
/// Parses "", "HDMI-A-1" or "1:HDMI-A-1", with cards counted from 0. Errors: kInvalidArgument for any other form.
Result<ConnectorPreference> parse_connector_preference(std::string_view text);

struct AvailableConnector {
  ConnectorId socket;
  bool is_connected = false;
  std::string serial{};  ///< Serial of the connected projector; empty if it has none.
};

/// Returns the connector of each head, or nothing while none is known. `seen` is in the order of the cards. A head
/// keeps its connector from `before` (empty at first) permanently, so that a projector that is switched off and on, or
/// replaced, gets the same picture again. Only a head with a serial moves, to the connector on which its projector is
/// found; a head that it drives out is without one until its own is found. Heads without a preference take, in order,
/// connected connectors that no other head has or requests. Precondition: `before` is empty or as long as
/// `preferences`.
[[nodiscard]] std::vector<std::optional<ConnectorId>> assign_connectors(
    std::span<const ConnectorPreference> preferences, std::span<const AvailableConnector> seen,
    std::span<const std::optional<ConnectorId>> before);

}  // namespace cyclorama::output

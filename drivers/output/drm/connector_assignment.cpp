// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/connector_assignment.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/check.h"
#include "common/base/text.h"

namespace cyclorama::output {
namespace {

bool fits(const ConnectorPreference& preferred, const ConnectorId& socket) {
  return (!preferred.card || *preferred.card == socket.card) && preferred.connector == socket.connector;
}

}  // namespace

Result<ConnectorPreference> parse_connector_preference(std::string_view text) {
  constexpr long long kMaxCards = 16;
  ConnectorPreference preferred;
  std::string_view connector = text;
  if (const std::size_t colon = text.find(':'); colon != std::string_view::npos) {
    const auto card = parse_integer(text.substr(0, colon));
    connector = text.substr(colon + 1);
    if (!card || *card < 0 || *card >= kMaxCards || connector.empty()) {
      return Error(
          ErrorCode::kInvalidArgument,
          fmt::format("'{}' names no connector; write HDMI-A-1, or 1:HDMI-A-1 for the second card", printable(text)));
    }
    preferred.card = static_cast<std::size_t>(*card);
  }
  preferred.connector = connector;
  return preferred;
}

std::vector<std::optional<ConnectorId>> assign_connectors(std::span<const ConnectorPreference> preferences,
                                                          std::span<const AvailableConnector> seen,
                                                          std::span<const std::optional<ConnectorId>> before) {
  CHECK(before.empty() || before.size() == preferences.size());
  std::vector<std::optional<ConnectorId>> placed(before.begin(), before.end());
  placed.resize(preferences.size());
  const auto is_taken = [&](const ConnectorId& socket) {
    return std::find(placed.begin(), placed.end(), socket) != placed.end();
  };
  const auto is_named = [&](const ConnectorId& socket) {
    return std::any_of(preferences.begin(), preferences.end(),
                       [&](const ConnectorPreference& w) { return fits(w, socket); });
  };
  const auto first_free = [&](auto is_fit) -> std::optional<ConnectorId> {
    const auto found = std::find_if(seen.begin(), seen.end(),
                                    [&](const AvailableConnector& s) { return is_fit(s) && !is_taken(s.socket); });
    return found == seen.end() ? std::nullopt : std::optional(found->socket);
  };
  for (std::size_t i = 0; i < preferences.size(); ++i) {
    if (preferences[i].serial.empty()) continue;
    const auto has_it = [&](const AvailableConnector& s) {
      return s.is_connected && s.serial == preferences[i].serial && !is_named(s.socket);
    };
    // Several with this serial cannot be told from each other; the head stays where it is, if that is one of them.
    const auto stays =
        std::find_if(seen.begin(), seen.end(), [&](const auto& s) { return has_it(s) && placed[i] == s.socket; });
    const auto found = stays != seen.end() ? stays : std::find_if(seen.begin(), seen.end(), has_it);
    if (found == seen.end()) continue;
    for (std::optional<ConnectorId>& other : placed) {
      if (other == found->socket) other.reset();
    }
    placed[i] = found->socket;
  }
  for (std::size_t i = 0; i < preferences.size(); ++i) {
    if (!placed[i] && !preferences[i].connector.empty())
      placed[i] = first_free([&](const AvailableConnector& s) { return fits(preferences[i], s.socket); });
  }
  for (std::size_t i = 0; i < preferences.size(); ++i) {
    if (!placed[i] && preferences[i].connector.empty() && preferences[i].serial.empty())
      placed[i] = first_free([&](const AvailableConnector& s) { return s.is_connected && !is_named(s.socket); });
  }
  return placed;
}

}  // namespace cyclorama::output

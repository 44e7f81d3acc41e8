// SPDX-License-Identifier: Apache-2.0
/// Which of a card's CRTCs (the circuits that scan pictures out) feeds which connector. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace cyclorama::output {

/// For each connector the CRTC's number, or nothing where the card has too few that fit. `possible_crtcs` has one mask
/// per connector: bit n is set when CRTC n can feed it. As many connectors as possible get one (augmenting paths);
/// where CRTCs are too few, whoever has one in `keep` still has one, and then the earlier in the list wins.
/// Precondition: keep is empty or as long as possible_crtcs.
[[nodiscard]] std::vector<std::optional<std::size_t>> assign_crtcs(
    std::span<const std::uint32_t> possible_crtcs, std::span<const std::optional<std::size_t>> keep = {});

}  // namespace cyclorama::output

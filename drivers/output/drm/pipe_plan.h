// SPDX-License-Identifier: Apache-2.0
/// Assignment of a card's CRTCs, the circuits that scan pictures out, to connectors. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace cyclorama::output {

/// Returns the index of the CRTC for each connector, or nothing if the card has too few suitable ones. `possible_crtcs`
/// has one mask per connector: bit n is set if CRTC n can feed it. As many connectors as possible get one (augmenting
/// paths); if there are too few, connectors with an entry in `keep` take precedence, then earlier ones.
/// An entry in `keep` is changed only if another connector would get none otherwise. Precondition:
/// `keep` is empty or as long as `possible_crtcs`.
[[nodiscard]] std::vector<std::optional<std::size_t>> assign_crtcs(
    std::span<const std::uint32_t> possible_crtcs, std::span<const std::optional<std::size_t>> keep = {});

}  // namespace cyclorama::output

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/edid/edid.h"

namespace cyclorama {

/// A connector of a graphics card, and the projector on it, as the kernel found them last. A value.
struct Socket {
  std::string card;       ///< "card0".
  std::string connector;  ///< "HDMI-A-1".
  bool is_connected = false;
  std::optional<Edid> edid{};  ///< Nothing if the EDID is missing or damaged.
};

/// Reads the kernel's present list of connectors, which needs no right on the cards and probes nothing. Ordered by
/// name; empty without graphics cards. `drm` is the kernel's folder.
[[nodiscard]] std::vector<Socket> list_sockets(const std::filesystem::path& drm = "/sys/class/drm");

/// Returns a text for people on the connected ones, such as "HDMI-A-1 (EPS EB-L1755U, serial "X4K1"), DP-2 (no EDID)";
/// "nothing" if there is none. Names the card if there are several.
[[nodiscard]] std::string text_of_connected(std::span<const Socket> sockets);

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/output/drm/edid.h"
#include "drivers/output/drm/properties.h"

namespace cyclorama::output {

/// A socket of the card, and what hangs on it now. A value; reentrant.
struct Connector {
  std::string name;  ///< As the kernel calls it: "HDMI-A-1".
  bool is_connected = false;
  bool is_link_bad = false;  ///< The cable's training failed since the last modeset, which must be done again.
  std::uint32_t possible_crtcs = 0;
  std::vector<drmModeModeInfo> modes;
  std::vector<std::uint8_t> edid_bytes;
  std::optional<Edid> edid;  ///< Nothing when there is none, or a damaged one.
  Properties properties;

  [[nodiscard]] std::uint32_t id() const { return properties.object_id(); }
  /// Most bits per primary that both ends of the cable take; 8 where they do not say.
  [[nodiscard]] int colour_bits() const;
  /// Whether what hangs on it is what it was: the same projector with the same modes, link and state.
  [[nodiscard]] bool is_same_as(const Connector& other) const;
};

/// Asks the projector, which takes some milliseconds each. Errors as errno says; a connector may vanish (a dock).
Result<Connector> probe_connector(int fd, std::uint32_t id);

}  // namespace cyclorama::output

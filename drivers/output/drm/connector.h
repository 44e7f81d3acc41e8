// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/edid/edid.h"
#include "drivers/output/drm/properties.h"

namespace cyclorama::output {

/// A connector of the card and the sink that is plugged in now. A value; reentrant.
struct Connector {
  std::string name;  ///< Name given by the kernel: "HDMI-A-1".
  bool is_connected = false;
  bool is_link_bad = false;  ///< Link training failed since the last modeset; a new modeset is needed.
  std::uint32_t possible_crtcs = 0;
  std::vector<drmModeModeInfo> modes;
  std::vector<std::uint8_t> edid_bytes;
  std::optional<Edid> edid;  ///< Nothing if the EDID is missing or damaged.
  std::string edid_fault;    ///< Why there is no `edid` although something is connected.
  Properties properties;

  [[nodiscard]] std::uint32_t id() const { return properties.object_id(); }
  /// Maximum bits per primary that both ends of the cable support; 8 if they do not report it.
  [[nodiscard]] int colour_bits() const;
  /// True if the sink is unchanged: the same projector with the same modes, link and state.
  [[nodiscard]] bool is_same_as(const Connector& other) const;
};

/// Reads the connector's state, after a probe if `is_probed`, which takes tens of milliseconds (DDC over the cable).
/// Errors: from errno; a connector may vanish (as with a dock).
Result<Connector> read_connector(int fd, std::uint32_t id, bool is_probed);

}  // namespace cyclorama::output

// SPDX-License-Identifier: Apache-2.0
/// What a projector says of itself (VESA E-EDID 1.4, base block). The kernel makes the list of modes from it; here is
/// read what the kernel does not tell: who it is and how deep its colours are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "common/base/result.h"

namespace cyclorama::output {

/// A value; reentrant.
struct Edid {
  std::string maker;  ///< Three capital letters: the PNP id.
  std::string model;  ///< As its menu says; empty when it does not.
  std::string serial;
  std::uint16_t product = 0;
  int colour_bits = 0;  ///< Per primary, on a digital input; 0: it does not say.

  /// "EPS EB-L1755U 000123", for people; printable ASCII whatever the projector sent.
  [[nodiscard]] std::string text() const;
};

/// kBadData  not an EDID: too short, another header, or a checksum that does not add up; names the byte.
Result<Edid> parse_edid(std::span<const std::uint8_t> bytes);

}  // namespace cyclorama::output

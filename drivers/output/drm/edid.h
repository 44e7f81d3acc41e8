// SPDX-License-Identifier: Apache-2.0
/// Identification data of a projector (VESA E-EDID 1.4, base block). The kernel derives the modes from it; this parser
/// reads what the kernel does not export: the identity and the colour depth.
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
  std::string model;  ///< Display name descriptor; empty if absent.
  std::string serial;
  std::uint16_t product = 0;
  int colour_bits = 0;  ///< Bits per primary on a digital input; 0 if undefined.

  /// Returns a text for people, such as "EPS EB-L1755U 000123"; printable ASCII for any input.
  [[nodiscard]] std::string text() const;
};

/// Errors: kBadData if this is not an EDID (too short, wrong header or checksum); the message names the byte.
Result<Edid> parse_edid(std::span<const std::uint8_t> bytes);

}  // namespace cyclorama::output

// SPDX-License-Identifier: Apache-2.0
/// Identification data of a projector: VESA E-EDID 1.0 to 1.4, with CTA-861 and DisplayID extensions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/edid/video_timing.h"

namespace cyclorama {

/// A value; reentrant.
struct Edid {
  std::string maker;   ///< Three capital letters: the PNP id.
  std::string model;   ///< Display name descriptor; empty if absent.
  std::string serial;  ///< Serial number descriptor, else the serial number in digits; empty if the device has neither.
  std::uint16_t product = 0;
  int colour_bits = 0;  ///< Bits per primary on a digital input; 0 if undefined.
  /// Possible timings without duplicates, preferred ones first; empty if the device lists none.
  std::vector<VideoTiming> timings;

  /// Returns a text for people, such as "EPS EB-L1755U 000123"; printable ASCII for any input.
  [[nodiscard]] std::string text() const;
};

/// Parses the base block and whatever extension blocks are whole; a damaged extension, or a timing that no card could
/// make, is left out. Errors: kBadData if this is not an EDID (too short, wrong header or checksum); the message names
/// the byte.
Result<Edid> parse_edid(std::span<const std::uint8_t> bytes);

/// Reads a file with an EDID. Errors: those of read_file() and parse_edid().
Result<Edid> read_edid_file(const std::filesystem::path& path);
/// Reads the EDID of a projector that does not report it. Errors: those of read_edid_file(); kBadData if it has no
/// timing.
Result<Edid> read_edid_to_drive(const std::filesystem::path& path);

}  // namespace cyclorama

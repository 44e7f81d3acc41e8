// SPDX-License-Identifier: Apache-2.0
#include "common/edid/edid.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "common/base/file.h"
#include "common/edid/edid_timings.h"

namespace cyclorama {
namespace {

constexpr std::array<std::uint8_t, 8> kHeader{0x00, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x00};
constexpr std::size_t kMaker = 8;
constexpr std::size_t kInput = 20;
constexpr std::size_t kFirstDescriptor = 54;
constexpr std::size_t kDescriptors = 4;
constexpr std::uint8_t kSerialText = 0xff;
constexpr std::uint8_t kNameText = 0xfc;

/// Returns the text of a descriptor (table 3.23): up to 13 characters, terminated by a line feed and padded with
/// spaces.
std::string text_of(std::span<const std::uint8_t> descriptor) {
  std::string text;
  for (const std::uint8_t byte : descriptor.subspan(5)) {
    if (byte == '\n') break;
    text += byte >= 0x20 && byte < 0x7f ? static_cast<char>(byte) : '?';
  }
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

std::string maker_of(std::uint8_t high, std::uint8_t low) {
  const unsigned packed = static_cast<unsigned>(high) << 8 | low;
  std::string maker;
  for (const unsigned shift : {10U, 5U, 0U}) {
    const unsigned letter = packed >> shift & 0x1f;
    maker += letter >= 1 && letter <= 26 ? static_cast<char>('A' + letter - 1) : '?';
  }
  return maker;
}

/// Returns the bits per primary (table 3.11): three bits for a digital input of version 1.4; 0 for other or reserved
/// values.
int colour_bits_of(std::uint8_t revision, std::uint8_t input) {
  constexpr std::array<int, 8> kDepths{0, 6, 8, 10, 12, 14, 16, 0};
  if (revision < 4 || (input & 0x80) == 0) return 0;
  return kDepths[input >> 4 & 7];
}

/// Returns the serial number of bytes 12 to 15; empty for 0 and 0x01010101, which makers use for none.
std::string serial_in_digits(std::span<const std::uint8_t> bytes) {
  constexpr std::uint32_t kNone = 0x01010101;
  std::uint32_t serial = 0;
  for (std::size_t i = 0; i < 4; ++i) serial |= static_cast<std::uint32_t>(bytes[12 + i]) << 8 * i;
  return serial == 0 || serial == kNone ? std::string() : std::to_string(serial);
}

}  // namespace

std::string Edid::text() const {
  std::string text = maker;
  for (const std::string& part : {model.empty() ? fmt::format("{:04x}", product) : model, serial}) {
    if (!part.empty()) text += " " + part;
  }
  return text;
}

Result<Edid> parse_edid(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kEdidBlock)
    return Error(ErrorCode::kBadData, fmt::format("an EDID of {} bytes; it has at least {}", bytes.size(), kEdidBlock));
  const std::span<const std::uint8_t> all = bytes;
  bytes = bytes.first(kEdidBlock);
  const auto [wrong, expected] = std::mismatch(bytes.begin(), bytes.begin() + kHeader.size(), kHeader.begin());
  if (expected != kHeader.end()) {
    return Error(ErrorCode::kBadData, fmt::format("not an EDID: byte {} is 0x{:02x} instead of 0x{:02x}",
                                                  wrong - bytes.begin(), *wrong, *expected));
  }
  const unsigned sum = std::accumulate(bytes.begin(), bytes.end(), 0U) & 0xff;
  if (sum != 0) {
    return Error(ErrorCode::kBadData, fmt::format("the EDID's bytes add up to 0x{:02x} instead of 0 (byte 127 is its "
                                                  "checksum); try another cable",
                                                  sum));
  }
  Edid edid;
  edid.maker = maker_of(bytes[kMaker], bytes[kMaker + 1]);
  edid.product = static_cast<std::uint16_t>(bytes[10] | bytes[11] << 8);
  edid.colour_bits = colour_bits_of(bytes[19], bytes[kInput]);
  for (std::size_t i = 0; i < kDescriptors; ++i) {
    const auto descriptor = bytes.subspan(kFirstDescriptor + i * kEdidDescriptor, kEdidDescriptor);
    if (descriptor[0] != 0 || descriptor[1] != 0) continue;  // A timing descriptor, which the kernel parses.
    if (descriptor[3] == kNameText) edid.model = text_of(descriptor);
    if (descriptor[3] == kSerialText) edid.serial = text_of(descriptor);
  }
  if (edid.serial.empty()) edid.serial = serial_in_digits(bytes);
  edid.timings = edid_timings(all);
  return edid;
}

Result<Edid> read_edid_file(const std::filesystem::path& path) {
  constexpr std::size_t kMaxBytes = 256 * kEdidBlock;
  TRY_ASSIGN(const std::vector<std::byte> bytes, read_file(path, kMaxBytes));
  auto edid = parse_edid(std::span(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()));
  if (!edid) return std::move(edid).error().while_doing(path.string());
  return edid;
}

Result<Edid> read_edid_to_drive(const std::filesystem::path& path) {
  TRY_ASSIGN(Edid edid, read_edid_file(path));
  if (edid.timings.empty()) {
    return Error(ErrorCode::kBadData,
                 fmt::format("{}: this EDID lists no timing; copy that of a projector of the same model, from "
                             "/sys/class/drm/card0-HDMI-A-1/edid while it is connected",
                             path.string()));
  }
  return edid;
}

}  // namespace cyclorama

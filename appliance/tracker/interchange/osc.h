// SPDX-License-Identifier: Apache-2.0
/// Open Sound Control 1.0, the protocol of museums' other programs: packets of messages, big-endian, in units of four
/// bytes. Source: opensoundcontrol.stanford.edu/spec-1_0.html. The types i f s b h d t T F N I are supported.
///
///   "/cyclorama/pose\0" ",iihddd...\0" arguments          or   "#bundle\0" time size packet size packet ...
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::tracker {

struct OscNothing {
  friend bool operator==(const OscNothing&, const OscNothing&) = default;
};
/// A time as in NTP: seconds since 1900 and their fractions; 1 means "at once".
struct OscTime {
  std::uint64_t ntp = 1;
  friend bool operator==(const OscTime&, const OscTime&) = default;
};
using OscArgument = std::variant<std::int32_t, float, std::string, std::vector<std::byte>, std::int64_t, double,
                                 OscTime, bool, OscNothing>;

struct OscMessage {
  std::string address;
  std::vector<OscArgument> arguments;

  /// Returns the argument as a number, whatever its type; empty if it is absent or no number.
  [[nodiscard]] std::optional<double> number(std::size_t index) const;
  friend bool operator==(const OscMessage&, const OscMessage&) = default;
};

/// Encodes a message. Precondition: texts contain no NUL byte.
[[nodiscard]] std::vector<std::byte> encode_osc(const OscMessage& message);

/// Returns the messages of a packet; those of nested bundles in order. Errors: kBadData for parts that are not padded
/// with zeros to four bytes, unknown types, wrong lengths, and bundles nested deeper than kMaxOscBundleDepth.
Result<std::vector<OscMessage>> decode_osc(std::span<const std::byte> packet);
inline constexpr int kMaxOscBundleDepth = 8;

}  // namespace cyclorama::tracker

// SPDX-License-Identifier: Apache-2.0
/// Views as text. The text contains everything that a picture depends on, so equal texts mean equal pictures.
#pragma once

#include <fmt/format.h>

#include <charconv>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>

#include "common/wire/view.pb.h"

namespace cyclorama {

inline std::string to_hex(const wire::View& view) {
  std::string hex;
  for (const char byte : view.SerializeAsString()) {
    fmt::format_to(std::back_inserter(hex), "{:02x}", static_cast<unsigned char>(byte));
  }
  return hex;
}

/// Parses a text of to_hex(). Returns nothing for text that to_hex() never writes.
inline std::optional<wire::View> view_from_hex(std::string_view hex) {
  std::string bytes;
  for (; hex.size() >= 2; hex.remove_prefix(2)) {
    unsigned char byte = 0;
    const auto [end, error] = std::from_chars(hex.data(), hex.data() + 2, byte, 16);
    if (error != std::errc() || end != hex.data() + 2) return std::nullopt;
    bytes += static_cast<char>(byte);
  }
  wire::View view;
  if (!hex.empty() || !view.ParseFromString(bytes)) return std::nullopt;
  return view;
}

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_uri.h"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "common/base/text.h"

namespace cyclorama::scene {
namespace {

constexpr std::string_view kDataScheme = "data:";
constexpr std::uint8_t kNotBase64 = 0xff;

constexpr std::array<std::uint8_t, 256> base64_values() {
  std::array<std::uint8_t, 256> values{};
  values.fill(kNotBase64);
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < kAlphabet.size(); ++i) {
    values[static_cast<unsigned char>(kAlphabet[i])] = static_cast<std::uint8_t>(i);
  }
  return values;
}
constexpr std::array<std::uint8_t, 256> kBase64Values = base64_values();

Result<std::vector<std::byte>> decode_base64(std::string_view text) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  if (text.size() % 4 == 1) return Error(ErrorCode::kBadData, "the base64 data is cut short");
  std::vector<std::byte> bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int held = 0;
  for (const char c : text) {
    const std::uint8_t value = kBase64Values[static_cast<unsigned char>(c)];
    if (value == kNotBase64) return Error(ErrorCode::kBadData, "the data is not base64");
    bits = bits << 6 | value;
    held += 6;
    if (held >= 8) {
      held -= 8;
      bytes.push_back(static_cast<std::byte>(bits >> held & 0xffU));
    }
  }
  return bytes;
}

std::optional<unsigned> hex_digit(char c) {
  if (c >= '0' && c <= '9') return static_cast<unsigned>(c - '0');
  if (c >= 'a' && c <= 'f') return static_cast<unsigned>(c - 'a') + 10;
  if (c >= 'A' && c <= 'F') return static_cast<unsigned>(c - 'A') + 10;
  return std::nullopt;
}

// Decodes percent escapes. A '%' that does not begin an escape is kept, because exporters often leave it unescaped.
std::string percent_decoded(std::string_view text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size()) {
      const std::optional<unsigned> high = hex_digit(text[i + 1]);
      const std::optional<unsigned> low = hex_digit(text[i + 2]);
      if (high && low) {
        decoded += static_cast<char>(*high * 16 + *low);
        i += 2;
        continue;
      }
    }
    decoded += text[i];
  }
  return decoded;
}

// Returns true if `uri` begins with a scheme (RFC 3986), such as "name:", before any slash.
bool has_scheme(std::string_view uri) {
  const std::size_t end = uri.find_first_of(":/?#");
  return end != std::string_view::npos && uri[end] == ':';
}

}  // namespace

bool is_data_uri(std::string_view uri) { return uri.substr(0, kDataScheme.size()) == kDataScheme; }

std::size_t data_uri_bytes(std::string_view uri) { return 2 * uri.size() + 3; }

Result<std::vector<std::byte>> decode_data_uri(std::string_view uri) {
  constexpr std::string_view kBase64 = ";base64";
  const std::size_t comma = uri.find(',');
  if (!is_data_uri(uri) || comma == std::string_view::npos) {
    return Error(ErrorCode::kBadData, "the data URI has no comma before its data");
  }
  const std::string_view header = uri.substr(0, comma);
  if (header.size() < kBase64.size() || header.substr(header.size() - kBase64.size()) != kBase64) {
    const std::string decoded = percent_decoded(uri.substr(comma + 1));
    const std::span<const std::byte> bytes = std::as_bytes(std::span(decoded));
    return std::vector<std::byte>(bytes.begin(), bytes.end());
  }
  return decode_base64(uri.substr(comma + 1));
}

Result<std::filesystem::path> resolve_relative_uri(const std::filesystem::path& folder, std::string_view uri) {
  const auto refused = [&](std::string_view why) {
    return Error(ErrorCode::kBadData, fmt::format("'{}' {}; put the file beside the scene and refer to it by its name",
                                                  printable(uri), why));
  };
  if (uri.empty()) return refused("names no file");
  if (has_scheme(uri)) return refused("is not a file beside the scene");
  const std::string decoded = percent_decoded(uri);
  if (decoded.find('\0') != std::string::npos) return refused("names no file");
  const std::filesystem::path relative = std::filesystem::path(decoded).lexically_normal();
  if (relative.is_absolute()) return refused("is an absolute path");
  if (relative.begin() != relative.end() && *relative.begin() == "..") return refused("is outside the scene's folder");
  return folder / relative;
}

}  // namespace cyclorama::scene

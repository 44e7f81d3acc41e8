// SPDX-License-Identifier: Apache-2.0
#include "common/http/request_extent.h"

#include <algorithm>
#include <charconv>
#include <optional>

namespace cyclorama {
namespace {

constexpr std::string_view kEndOfLine = "\r\n";
constexpr std::string_view kEndOfHead = "\r\n\r\n";

bool is_name(std::string_view text, std::string_view lower_case) {
  return std::equal(text.begin(), text.end(), lower_case.begin(), lower_case.end(),
                    [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

std::optional<std::size_t> number_in(std::string_view text) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

RequestExtent request_extent(std::string_view received, std::size_t max_head_bytes, std::size_t max_body_bytes) {
  const std::size_t head_end = received.substr(0, max_head_bytes).find(kEndOfHead);
  if (head_end == std::string_view::npos) return {.refusal = received.size() >= max_head_bytes ? 431 : 0};
  std::optional<std::size_t> body;
  std::string_view lines = received.substr(0, head_end);
  while (!lines.empty()) {
    const std::size_t end = std::min(lines.find(kEndOfLine), lines.size());
    const std::string_view line = lines.substr(0, end);
    lines.remove_prefix(std::min(end + kEndOfLine.size(), lines.size()));
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) continue;
    const std::string_view name = line.substr(0, colon);
    if (is_name(name, "transfer-encoding")) return {.refusal = 411};
    if (!is_name(name, "content-length")) continue;
    const auto length = number_in(trimmed(line.substr(colon + 1)));
    if (!length || (body && *body != *length)) return {.refusal = 400};
    body = length;
  }
  const std::size_t head = head_end + kEndOfHead.size();
  if (body.value_or(0) > max_body_bytes) return {.bytes = head, .is_body_left_out = true};
  return {.bytes = head + body.value_or(0)};
}

}  // namespace cyclorama

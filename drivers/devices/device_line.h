// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace cyclorama::devices {

/// Splits `text` at the first `separator`; the rest is empty if there is none.
inline std::string_view cut(std::string_view* text, char separator) {
  const std::size_t at = text->find(separator);
  const std::string_view first = text->substr(0, at);
  *text = at == std::string_view::npos ? std::string_view() : text->substr(at + 1);
  return first;
}

}  // namespace cyclorama::devices

// SPDX-License-Identifier: Apache-2.0
/// Small questions about text that several folders ask.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace cyclorama {

/// A decimal floating-point number that fills the whole text, whatever the locale; nothing otherwise.
std::optional<double> parse_double(std::string_view text);
std::optional<long long> parse_integer(std::string_view text);

/// For people: control characters and bytes that are not UTF-8 become '?', and text of more than `limit` bytes is cut
/// between characters, with an ellipsis. What comes out is always UTF-8.
std::string printable(std::string_view text, std::size_t limit = 60);

}  // namespace cyclorama

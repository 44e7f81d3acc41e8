// SPDX-License-Identifier: Apache-2.0
/// Functions for texts that several folders use.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace cyclorama {

/// Parses a decimal floating-point number that fills the whole text, independent of the locale; empty otherwise.
std::optional<double> parse_double(std::string_view text);
std::optional<long long> parse_integer(std::string_view text);

/// Makes a text printable: control characters and bytes that are not UTF-8 become '?', and a text of more than `limit`
/// bytes is cut between characters, with an ellipsis. The result is always UTF-8.
std::string printable(std::string_view text, std::size_t limit = 60);

}  // namespace cyclorama

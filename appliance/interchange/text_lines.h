// SPDX-License-Identifier: Apache-2.0
/// Text line by line, with line numbers for errors.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "appliance/interchange/fault.h"
#include "common/base/result.h"
#include "common/base/text.h"
#include "common/base/text_lines.h"

namespace cyclorama::interchange {

/// Iterates over lines. Borrows the text. Thread-bound.
class TextLines {
 public:
  explicit TextLines(std::string_view text) : lines_(text) {}

  /// Returns the next line that is not blank, without surrounding blanks; empty at the end.
  std::optional<std::string_view> next() {
    std::string_view line;
    while (lines_.next(&line)) {
      ++number_;
      line = trimmed(line);
      if (!line.empty()) return line;
    }
    return std::nullopt;
  }
  /// Returns the location of the line that next() returned last: "line 12".
  [[nodiscard]] std::string location() const { return fmt::format("line {}", number_); }

 private:
  LineReader lines_;
  std::size_t number_ = 0;
};

/// Splits a line at blanks, or at `separator` if one is given; fields may then be empty.
inline std::vector<std::string_view> fields_of(std::string_view line, char separator = ' ') {
  std::vector<std::string_view> fields;
  const std::string_view ends = separator == ' ' ? std::string_view(" \t") : std::string_view(&separator, 1);
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = std::min(line.find_first_of(ends, at), line.size());
    if (separator != ' ' || end > at) fields.push_back(line.substr(at, end - at));
    at = end + 1;
  }
  return fields;
}

/// Parses a finite number; otherwise returns a fault at `location`.
inline Result<double> number_of(std::string_view field, std::string_view location) {
  const auto value = parse_double(field);
  if (!value || !std::isfinite(*value)) {
    return fault(location, fmt::format("'{}' is no number", printable(field)), "export the file again");
  }
  return *value;
}

/// Prints seven decimals, without a negative zero: a number that is read from the text prints the same text.
inline std::string decimals(double value) { return fmt::format("{:.7f}", std::abs(value) < 0.5e-7 ? 0.0 : value); }

}  // namespace cyclorama::interchange

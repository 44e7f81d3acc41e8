// SPDX-License-Identifier: Apache-2.0
#include "common/base/text_lines.h"

#include <charconv>
#include <limits>

namespace cyclorama {

std::optional<double> number_in(std::string_view word, bool* ret_whole) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const char* const end = word.data() + word.size();
  double value = 0.0;
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (error == std::errc::invalid_argument) return std::nullopt;
  const std::string_view taken = word.substr(0, static_cast<std::size_t>(stop - word.data()));
  if (error == std::errc::result_out_of_range) {
    const bool tiny = taken.find("e-") != std::string_view::npos || taken.find("E-") != std::string_view::npos;
    value = tiny ? 0.0 : std::numeric_limits<double>::infinity();
  }
  const bool microsoft = stop != end && *stop == '#';
  if (microsoft) value = std::numeric_limits<double>::quiet_NaN();
  if (ret_whole != nullptr) *ret_whole = stop == end || microsoft;
  return value;
}

}  // namespace cyclorama

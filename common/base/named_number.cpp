// SPDX-License-Identifier: Apache-2.0
#include "common/base/named_number.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "common/base/text.h"

namespace cyclorama {

Result<NamedNumber> parse_named_number(std::string_view text) {
  const std::size_t equals = text.rfind('=');
  if (equals != std::string_view::npos && equals > 0) {
    NamedNumber parsed{std::string(text.substr(0, equals))};
    const char* const end = text.data() + text.size();
    const auto read = std::from_chars(text.data() + equals + 1, end, parsed.number);
    if (read.ec == std::errc() && read.ptr == end && std::isfinite(parsed.number)) return parsed;
  }
  return Error(ErrorCode::kInvalidArgument,
               fmt::format("'{}' is no name with a number; write for example daylight=0.2", printable(text)));
}

}  // namespace cyclorama

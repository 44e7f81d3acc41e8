// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "common/base/result.h"

namespace cyclorama {

/// A number with a name, such as "daylight=0.2".
struct NamedNumber {
  std::string name;
  double number = 0.0;
};

/// Parses NAME=NUMBER; the name may contain spaces. Errors: kInvalidArgument, which quotes the text.
[[nodiscard]] Result<NamedNumber> parse_named_number(std::string_view text);

}  // namespace cyclorama

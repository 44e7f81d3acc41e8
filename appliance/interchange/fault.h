// SPDX-License-Identifier: Apache-2.0
/// Common form of the errors of all readers in this folder: location in the file, fault, and remedy.
#pragma once

#include <fmt/format.h>

#include <string_view>

#include "common/base/error.h"

namespace cyclorama::interchange {

/// Returns the error kBadData "location: what; remedy". Readers of files prepend the file's name.
[[nodiscard]] inline Error fault(std::string_view location, std::string_view what, std::string_view remedy,
                                 SourceLine where = SourceLine::current()) {
  return Error(ErrorCode::kBadData, fmt::format("{}: {}; {}", location, what, remedy), where);
}

}  // namespace cyclorama::interchange

// SPDX-License-Identifier: Apache-2.0
/// The one shape of every reader's error here: where in the file, what is wrong, and what to do about it.
#pragma once

#include <fmt/format.h>

#include <string_view>

#include "common/base/error.h"

namespace cyclorama::interchange {

/// kBadData "place: what; remedy". Readers of files add the file's name in front.
[[nodiscard]] inline Error fault(std::string_view location, std::string_view what, std::string_view remedy,
                                 SourceLine where = SourceLine::current()) {
  return Error(ErrorCode::kBadData, fmt::format("{}: {}; {}", location, what, remedy), where);
}

}  // namespace cyclorama::interchange

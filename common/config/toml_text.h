// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace cyclorama {

/// Returns the text as a TOML string in quotes, with everything escaped that would end it or is not allowed in it.
[[nodiscard]] std::string toml_string(std::string_view text);

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

namespace cyclorama {

/// Returns the catalogues that were compiled into this program, as JSON (embed_catalogues.py).
[[nodiscard]] std::vector<std::string_view> embedded_catalogues();

}  // namespace cyclorama

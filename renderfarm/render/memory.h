// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace cyclorama {

/// Bytes that can still be taken before the machine swaps, from the text of /proc/meminfo. Nothing if it does not say.
[[nodiscard]] std::optional<std::size_t> parse_available_memory(std::string_view meminfo);

/// The same of this machine; nothing where /proc is absent.
[[nodiscard]] std::optional<std::size_t> available_memory();

/// "3.4 GB"
[[nodiscard]] std::string describe_bytes(std::size_t bytes);

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
/// URIs as glTF has them: data inside the text, or a file beside it, and nothing else.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string_view>
#include <vector>

#include "common/base/result.h"

namespace cyclorama {

[[nodiscard]] bool is_data_uri(std::string_view uri);
/// An upper bound of what decode_data_uri() gives and needs.
[[nodiscard]] std::size_t data_uri_bytes(std::string_view uri);
/// Base64, or text with percent escapes. kBadData  damaged, or not a data URI. Sources: RFC 2397, RFC 4648.
Result<std::vector<std::byte>> decode_data_uri(std::string_view uri);

/// The file that a relative reference names, after percent-decoding. kBadData  another scheme, an absolute path, or a
/// path that leaves `folder`: a scene never reads what was not delivered with it.
Result<std::filesystem::path> resolve_relative_uri(const std::filesystem::path& folder, std::string_view uri);

}  // namespace cyclorama

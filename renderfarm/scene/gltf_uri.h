// SPDX-License-Identifier: Apache-2.0
/// glTF's URIs: data inside the URI itself or files in the scene's folder, and nothing else.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string_view>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::scene {

[[nodiscard]] bool is_data_uri(std::string_view uri);
/// Returns an upper bound of the memory that decode_data_uri() needs, including its result.
[[nodiscard]] std::size_t data_uri_bytes(std::string_view uri);
/// Decodes base64, or text with percent escapes. Errors: kBadData if `uri` is damaged or not a data URI. Sources: RFC
/// 2397, RFC 4648.
Result<std::vector<std::byte>> decode_data_uri(std::string_view uri);

/// Returns the file that a relative reference names, after percent-decoding. Errors: kBadData for another scheme, an
/// absolute path, or a path that leaves `folder`: a scene reads only what was delivered with it.
Result<std::filesystem::path> resolve_relative_uri(const std::filesystem::path& folder, std::string_view uri);

}  // namespace cyclorama::scene

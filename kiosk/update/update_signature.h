// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

#include "common/base/result.h"

namespace cyclorama {

/// That `signature` is of `text`, by the holder of the key whose public half, a PEM, lies at `key` (openssl dgst
/// -sha256 -sign). kBadData  it is not.     kNotFound, kSystem  there is no such key.
Status check_signature(std::string_view text, std::string_view signature, const std::filesystem::path& key);

/// Of a whole file, in hexadecimal. kNotFound, kSystem  it cannot be read.
Result<std::string> sha256_of_file(const std::filesystem::path& path);

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

#include "common/base/result.h"

namespace cyclorama::update {

/// Verifies that `signature` signs `text` with the private key that belongs to one of the public keys in the PEM file
/// `key` (openssl dgst -sha256 -sign): while keys are changed, there is the old and the new one. Errors: kBadData if it
/// does not; kNotFound or kSystem if the keys cannot be read.
Status check_signature(std::string_view text, std::string_view signature, const std::filesystem::path& key);

/// Returns a file's hash in hexadecimal. Errors: kNotFound or kSystem if it cannot be read.
Result<std::string> sha256_of_file(const std::filesystem::path& path);

}  // namespace cyclorama::update

// SPDX-License-Identifier: Apache-2.0
/// The operator page's PIN, kept so that who reads it from the disk still has to guess: scrypt (RFC 7914) with a salt.
#pragma once

#include <string>
#include <string_view>

#include "common/base/result.h"

namespace cyclorama {

/// kInvalidArgument  shorter than 6 or longer than 64 characters, not printable ASCII, or the first that anybody tries
/// ("111111", "123456"). The message never holds the PIN.
Status check_pin(std::string_view pin);

/// "scrypt:15:8:1:SALT:HASH" in hexadecimal. Takes 32 MiB and a tenth of a second, which is its purpose.
/// Errors of check_pin(); kSystem  OpenSSL has no scrypt.
Result<std::string> hashed_pin(std::string_view pin);

/// Whether a PIN is the one. As slow as hashed_pin(), whatever the answer; the comparison takes the same time for all
/// wrong ones. kBadData  `hash` is none, or asks for more memory than 128 MiB.
Result<bool> is_pin(std::string_view pin, std::string_view hash);

}  // namespace cyclorama

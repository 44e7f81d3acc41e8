// SPDX-License-Identifier: Apache-2.0
/// Stores the operator page's PIN as a salted scrypt hash (RFC 7914), so that reading the disk does not reveal it.
#pragma once

#include <string>
#include <string_view>

#include "common/base/result.h"

namespace cyclorama::provision {

/// Errors: kInvalidArgument if the PIN is shorter than 6 or longer than 64 characters, not printable ASCII, or one that
/// everybody tries first ("111111", "123456"). The message never contains the PIN.
Status check_pin(std::string_view pin);

/// Returns "scrypt:15:8:1:SALT:HASH" in hexadecimal. Deliberately takes 32 MiB and a tenth of a second. Errors: those
/// of check_pin(); kSystem if OpenSSL has no scrypt.
Result<std::string> hashed_pin(std::string_view pin);

/// Returns whether the PIN matches the hash. It is as slow as hashed_pin() in either case, and the comparison takes the
/// same time for all wrong PINs. Errors: kBadData if `hash` is invalid or requires more than 128 MiB.
Result<bool> is_pin(std::string_view pin, std::string_view hash);

}  // namespace cyclorama::provision

// SPDX-License-Identifier: Apache-2.0
/// A museum's request for its next certificate (PKCS#10, RFC 2986).
#pragma once

#include <chrono>
#include <string>
#include <string_view>

#include "common/base/result.h"
#include "common/wire/identity.h"

namespace cyclorama {

/// Returns a new private key on the curve P-256, in PEM form. Errors: kSystem if OpenSSL cannot make one.
Result<std::string> new_private_key();

/// Returns a request, signed with the key, for a certificate of this role and name. Errors: kBadData if the key is none
/// on P-256 in PEM form; kSystem if OpenSSL fails.
Result<std::string> certificate_request(std::string_view key_pem, const Identity& who);

/// Reads a request of a peer, and checks its signature. The serial and the address stay empty. Errors: kBadData if it
/// is no request, its key is not on P-256, or its subject is not exactly one name and one known role.
Result<Identity> identity_in_request(std::string_view request_pem);

/// Returns whether the certificate is for the request's key. False for what cannot be read.
[[nodiscard]] bool is_for_request(std::string_view certificate_pem, std::string_view request_pem);

/// Returns the last second at which the first certificate of a PEM text is valid. Errors: kBadData if there is none.
Result<std::chrono::sys_seconds> end_of_certificate(std::string_view certificate_pem);

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/wire/tls.h"

namespace cyclorama::client {

/// Leaves a request for this museum's next certificate at the first coordinator that answers, and returns the
/// certificate if the farm's authority has made it by now, else an empty text. Blocks for at most 10 s per coordinator.
/// Checks nothing of the certificate.
///
/// Errors: those of make_channel(); kUnavailable or kTimedOut if none answers; kNotFound if the farm renews no
/// certificates, or is too old for it; kInvalidArgument if it refuses the request.
Result<std::string> renew_at_farm(const std::vector<std::string>& coordinators, const TlsFiles& tls,
                                  const std::string& request_pem);

}  // namespace cyclorama::client

// SPDX-License-Identifier: Apache-2.0
/// The operator page's own certificate. No authority can vouch for a museum's computer, so it is self-signed, and
/// people compare the fingerprint once.
#pragma once

#include <ctime>
#include <filesystem>
#include <string>

#include "common/base/result.h"

namespace cyclorama::operations {

struct PageCertificate {
  std::string certificate_pem;
  std::string key_pem;
  std::string fingerprint;  ///< SHA-256 as browsers show it: "4F:A1:...".
  std::string until;        ///< Last day: "2029-02-24".
};

/// Returns the certificate in `folder` (page.crt, page.key), or a new one for this computer's names if there is none,
/// it is damaged, or expires within two months. An existing key is kept. `now` is calendar time. Errors: kSystem if the
/// folder cannot be written, or OpenSSL fails.
Result<PageCertificate> page_certificate(const std::filesystem::path& folder, std::time_t now);

/// True once page_certificate() would return another one: the end is near, or the clock was set to before its first
/// day.
[[nodiscard]] bool is_to_be_renewed(const PageCertificate& page, std::time_t now);

}  // namespace cyclorama::operations

// SPDX-License-Identifier: Apache-2.0
/// The operator page's own certificate. No authority knows a museum's computer, so it signs itself, and people compare
/// the fingerprint once.
#pragma once

#include <filesystem>
#include <string>

#include "common/base/result.h"

namespace cyclorama {

struct PageCertificate {
  std::string certificate_pem;
  std::string key_pem;
  std::string fingerprint;  ///< SHA-256, as browsers show it: "4F:A1:...".
  std::string until;        ///< "2029-02-24".
};

/// The one in `folder` (page.crt, page.key), or a new one for this computer's names where there is none, it is damaged,
/// or runs out within two months. The key stays the same as long as it is there. `now` is the calendar's time.
/// kSystem  the folder cannot be written, or OpenSSL fails.
Result<PageCertificate> page_certificate(const std::filesystem::path& folder, std::time_t now);

}  // namespace cyclorama

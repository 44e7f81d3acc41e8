// SPDX-License-Identifier: Apache-2.0
/// Gets this museum's next certificate from its farm before the present one runs out:
///
///   FOLDER/next.key                    the next private key, kept until its certificate is in use
///   FOLDER/renewed/certificate.crt     with key.pem, complete; `cyclorama-provision renew` takes both into use
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>

#include "common/base/result.h"
#include "common/wire/tls.h"

namespace cyclorama::renewal {

inline constexpr const char* kRenewedFolder = "renewed";
inline constexpr const char* kCertificateFile = "certificate.crt";
inline constexpr const char* kKeyFile = "key.pem";
/// The next certificate is requested this long before the end of the present one.
inline constexpr std::chrono::days kBeforeEnd{30};

/// Leaves a request at the farm; returns the certificate, or an empty text if there is none yet.
using AskFarm = std::function<Result<std::string>(const std::string& request_pem)>;

struct RenewalOrder {
  TlsFiles tls{};                  ///< The certificate in use, with its key and its authority.
  std::filesystem::path folder{};  ///< Folder of this program; must exist.
  std::chrono::system_clock::time_point now{};
  AskFarm ask{};
};

struct RenewalOutcome {
  enum class Kind {
    kNotDue,   ///< The certificate is valid for longer than kBeforeEnd.
    kWaiting,  ///< The farm has the request, but no certificate yet.
    kReady,    ///< `folder`/renewed has the next certificate and its key.
  };
  Kind kind = Kind::kNotDue;
  std::string sentence{};
};

/// Returns whether a certificate with this end is to be renewed at `now`.
[[nodiscard]] bool is_due(std::chrono::sys_seconds end, std::chrono::system_clock::time_point now);

/// Goes one step further; call it again each night. The key stays the same until its certificate is in use, so neither
/// a power cut nor an authority that takes days costs anything. Errors: those of check() for the certificate in use, of
/// `ask` and of the disk; kBadData if what the farm returns is not a newer certificate of this museum, made by the same
/// authority: it is not used.
Result<RenewalOutcome> renew_certificate(const RenewalOrder& order);

}  // namespace cyclorama::renewal

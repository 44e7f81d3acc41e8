// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "common/base/result.h"
#include "common/wire/identity.h"

namespace cyclorama::trust {

/// The farm's folder of requests for certificates. The coordinator has no key of the authority: it only leaves what its
/// museums ask for, and hands out what the authority has made of it.
///
///   DIR/requests/hall-3.pem   a museum's newest request, written here
///   DIR/issued/hall-3.crt     its certificate, written by `cyclorama-authority renewals DIR`
///
/// Reentrant.
class Renewals {
 public:
  /// An empty folder name means that the farm renews no certificates.
  explicit Renewals(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Returns the certificate that the authority has made for this request; else keeps the request and returns nothing,
  /// an empty text. `who` is the caller, known by its present certificate.
  ///
  /// Errors: kNotFound if the farm renews no certificates; kInvalidArgument if the caller is no museum, or the request
  /// is not its own; kSystem if the disk fails.
  [[nodiscard]] Result<std::string> renew(const Identity& who, std::string_view request_pem) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace cyclorama::trust

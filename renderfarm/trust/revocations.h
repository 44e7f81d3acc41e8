// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <set>
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace cyclorama::trust {

/// The certificates that an authority has revoked, from its revocation list (CRL, RFC 5280), crl.pem. A value;
/// thread-bound.
class Revocations {
 public:
  /// Makes an empty list.
  Revocations() = default;
  /// Parses a list. Errors: kBadData if `pem` is not a list in PEM form, or if the authority, a certificate in PEM
  /// form, did not sign it.
  static Result<Revocations> parse(std::string_view pem, std::string_view authority_pem);

  /// Returns true if the certificate with this serial number is revoked. The number is upper-case hexadecimal, as in
  /// Identity.
  [[nodiscard]] bool contains(const std::string& serial) const { return serials_.contains(serial); }
  [[nodiscard]] std::size_t size() const { return serials_.size(); }
  /// Returns true after the time for which the authority announced the next list.
  [[nodiscard]] bool is_out_of_date() const;
  /// Returns the day for which the next list was announced; "?" if there is none.
  [[nodiscard]] const std::string& next_update() const { return next_update_; }

 private:
  std::set<std::string> serials_;
  std::string next_update_ = "?";
  std::chrono::system_clock::time_point good_until_ = std::chrono::system_clock::time_point::max();
};

}  // namespace cyclorama::trust

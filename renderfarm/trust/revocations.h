// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <set>
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace cyclorama::trust {

/// Certificates that an authority has revoked: its list (CRL, RFC 5280), crl.pem. A value; thread-bound.
class Revocations {
 public:
  /// An empty list.
  Revocations() = default;
  /// Errors: kBadData if this is no list in PEM form, or the authority (a certificate, PEM) did not sign it.
  static Result<Revocations> parse(std::string_view pem, std::string_view authority_pem);

  /// Serial numbers are upper-case hexadecimal, as in Identity.
  [[nodiscard]] bool contains(const std::string& serial) const { return serials_.contains(serial); }
  [[nodiscard]] std::size_t size() const { return serials_.size(); }
  /// True after the time by which the authority promised a newer list.
  [[nodiscard]] bool is_out_of_date() const;
  /// A day; "?" if the list has none.
  [[nodiscard]] const std::string& next_update() const { return next_update_; }

 private:
  std::set<std::string> serials_;
  std::string next_update_ = "?";
  std::chrono::system_clock::time_point good_until_ = std::chrono::system_clock::time_point::max();
};

}  // namespace cyclorama::trust

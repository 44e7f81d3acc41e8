// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <set>
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace cyclorama {

/// The certificates that an authority has taken back: its list (CRL, RFC 5280), crl.pem. A value; thread-bound.
class Revocations {
 public:
  /// None.
  Revocations() = default;
  /// kBadData  it is no list in PEM form, or that authority (a certificate, PEM) did not sign it.
  static Result<Revocations> parse(std::string_view pem, std::string_view authority_pem);

  /// By serial number in upper-case hexadecimal, as Identity has it.
  [[nodiscard]] bool contains(const std::string& serial) const { return serials_.contains(serial); }
  [[nodiscard]] std::size_t size() const { return serials_.size(); }
  /// The authority promised a newer one by then.
  [[nodiscard]] bool is_out_of_date() const;
  [[nodiscard]] const std::string& next_update() const { return next_update_; }  ///< A day; "?" when it has none.

 private:
  std::set<std::string> serials_;
  std::string next_update_ = "?";
  std::chrono::system_clock::time_point good_until_ = std::chrono::system_clock::time_point::max();
};

}  // namespace cyclorama

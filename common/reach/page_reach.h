// SPDX-License-Identifier: Apache-2.0
/// How people reach the operator page. The page writes it to a file, and the display shows it on the wall when somebody
/// requests help (appliance/display/reach_screen.h).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"

namespace cyclorama {

struct PageReach {
  std::string name;                    ///< The museum's, else this computer's.
  std::string version;                 ///< Version of the programs.
  std::string language;                ///< The museum's: "de"; empty: none was chosen yet.
  std::vector<std::string> addresses;  ///< "https://[2001:db8::7]:8443/"; the one that most phones reach is first.
  std::string fingerprint;             ///< SHA-256 of the page's certificate: "4F:A1:…"; empty without TLS.
  /// Proves at the login that somebody has seen the wall (Sessions::open()); empty: none.
  std::string wall_code;
  bool has_pin = false;   ///< Somebody can log in.
  TimePoint answered_at;  ///< Time when the page last answered itself and had an address; the epoch: never.

  friend bool operator==(const PageReach&, const PageReach&) = default;
};

[[nodiscard]] std::string to_json(const PageReach& reach);
/// Errors: kBadData with position and mistake; `name` stands for the file.
Result<PageReach> parse_page_reach(std::string_view text, const std::string& name);

/// Returns the link for a phone: the first address with the certificate's fingerprint and the wall's code after a '#',
/// which browsers do not send; empty if there is no address.
[[nodiscard]] std::string link_of(const PageReach& reach);

}  // namespace cyclorama

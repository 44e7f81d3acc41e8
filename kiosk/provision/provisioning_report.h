// SPDX-License-Identifier: Apache-2.0
/// Report on the settings of the newest USB stick: written by cyclorama-provision, shown by the operator page.
#pragma once

#include <ctime>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::provision {

inline constexpr const char* kProvisioningReportFile = "provisioning.json";

enum class ProvisioningVerdict {
  kInstalled,    ///< The new settings are in use.
  kUnchanged,    ///< The same settings are already in use.
  kRefused,      ///< `problems` has the reasons; the previous settings stay in use.
  kRestored,     ///< The previous settings are in use again.
  kUnconfirmed,  ///< The stick is not the owner's; `digest` names it for who may confirm it.
};

/// A value; in JSON {"at", "source", "verdict", "in_use", "museum", "farm": [], "projectors", "certificate_until",
/// "has_pin", "digest", "problems": [], "remarks": []}
struct ProvisioningReport {
  std::string at;      ///< UTC by this computer's clock: "2026-11-22T16:04:05Z".
  std::string source;  ///< The folder.
  ProvisioningVerdict verdict = ProvisioningVerdict::kRefused;
  std::string in_use;  ///< Number of the settings in use now; empty: none.
  /// The museum's name at the farm. This member and the following ones describe the settings that were checked.
  std::string museum;
  std::vector<std::string> farm;  ///< Addresses of the farm's coordinators.
  int projectors = 0;
  std::string certificate_until;  ///< "2029-02-24"; empty: none.
  bool has_pin = false;
  std::string digest;  ///< Hexadecimal SHA-256 of names and contents of a stick that waits for confirmation.
  std::vector<std::string> problems;  ///< Sentences with file, line and remedy.
  std::vector<std::string> remarks;

  bool operator==(const ProvisioningReport&) const = default;
};

[[nodiscard]] std::string_view to_text(ProvisioningVerdict verdict);
[[nodiscard]] std::string report_json(const ProvisioningReport& report);
/// Errors: kBadData if the text is not the JSON of a report.
Result<ProvisioningReport> parse_report(std::string_view json);

/// True for a SHA-256 in hexadecimal.
[[nodiscard]] bool is_digest(std::string_view text);

/// Returns the time in UTC: "2026-11-22T16:04:05Z".
[[nodiscard]] std::string time_text(std::time_t time);

}  // namespace cyclorama::provision

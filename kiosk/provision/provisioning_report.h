// SPDX-License-Identifier: Apache-2.0
/// What came of the newest stick: written by cyclorama-provision, shown by the operator page.
#pragma once

#include <ctime>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"

namespace cyclorama {

inline constexpr const char* kProvisioningReportFile = "provisioning.json";

enum class Verdict {
  kInstalled,  ///< The new settings are in use.
  kUnchanged,  ///< They are those in use already.
  kRefused,    ///< `problems` says why; the settings before stay in use.
  kRestored,   ///< Those of before are in use again.
};

/// A value. {"at", "source", "verdict", "in_use", "museum", "farm": [], "projectors", "certificate_until", "has_pin",
/// "problems": [], "remarks": []}
struct ProvisioningReport {
  std::string at;      ///< "2026-11-22T16:04:05Z", by this computer's clock.
  std::string source;  ///< The folder.
  Verdict verdict = Verdict::kRefused;
  std::string in_use;             ///< The number of the settings in use now; empty: none.
  std::string museum;             ///< Its name at the farm. This and the following are of what was looked at.
  std::vector<std::string> farm;  ///< Addresses of its heads.
  int projectors = 0;
  std::string certificate_until;  ///< "2029-02-24"; empty: none.
  bool has_pin = false;
  std::vector<std::string> problems;  ///< Sentences: file, line, what to do.
  std::vector<std::string> remarks;

  bool operator==(const ProvisioningReport&) const = default;
};

[[nodiscard]] std::string_view to_text(Verdict verdict);
[[nodiscard]] std::string report_json(const ProvisioningReport& report);
/// kBadData  not such JSON.
Result<ProvisioningReport> parse_report(std::string_view json);

/// "2026-11-22T16:04:05Z".
[[nodiscard]] std::string time_text(std::time_t time);

}  // namespace cyclorama

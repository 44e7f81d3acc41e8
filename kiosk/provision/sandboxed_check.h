// SPDX-License-Identifier: Apache-2.0
/// Checks a stick's settings in another process without root's rights, since the check parses foreign files.
///
///   cyclorama-provision install (root)                   cyclorama-check-settings.service (user cyclorama-check)
///   copies the stick, gives the copy to the user's group
///   starts the unit  ──────────────────────────────────▶ cyclorama-provision verdict: parses everything
///   reads its verdict, and trusts nothing else of it ◀── writes a verdict
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "kiosk/provision/settings_check.h"

namespace cyclorama::provision {

/// Writes a verdict as JSON, the PIN included: the file is for one reader.
[[nodiscard]] std::string verdict_json(const SettingsVerdict& verdict);
/// Errors: kBadData if the text is no verdict, or its secrets are not plain names for groups of our services.
Result<SettingsVerdict> parse_verdict(std::string_view json);

struct SandboxedCheck {
  std::vector<std::string> command;  ///< Runs the check to its end: "systemctl", "start", "UNIT".
  std::filesystem::path verdict;     ///< The file that it writes.
  std::string group;                 ///< Group of its user, which may read the copy; empty: nothing is given away.
};

/// Errors: kUnavailable if the check does not end with a verdict; those of parse_verdict(); kSystem if the copy cannot
/// be given to the group.
Result<SettingsVerdict> check_sandboxed(const std::filesystem::path& folder, const SandboxedCheck& how);

}  // namespace cyclorama::provision

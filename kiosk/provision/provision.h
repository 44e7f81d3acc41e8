// SPDX-License-Identifier: Apache-2.0
/// Puts settings from a USB stick into use, or reports why they cannot be used.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "common/base/result.h"
#include "kiosk/provision/provisioning_report.h"
#include "kiosk/provision/sandboxed_check.h"
#include "kiosk/provision/settings_check.h"
#include "kiosk/provision/settings_store.h"

namespace cyclorama::provision {

struct ProvisionOrder {
  std::filesystem::path from;
  SettingsCheck check{};
  FolderLimits limits{};
  bool only_check = false;  ///< Report the outcome without changing anything.
  std::string at;           ///< Time for the report, as time_text() formats it.
  /// True for what anybody can plug in: it must be the first, bear the owner's signature, or be confirmed.
  bool is_stick = false;
  /// True for what the operator page offers: files of the settings in use that the folder lacks stay, and a PIN may come
  /// as its hash.
  bool is_over = false;
  /// Checks the settings in another process instead of this one.
  std::optional<SandboxedCheck> sandbox{};
  std::string confirmed{};  ///< Digest of a stick that the operator confirmed on the page; empty: none.
};

/// Copies the folder, checks the copy, and puts it into use only if it has no problem. Bad settings are not an error;
/// they give a report with problems. Errors: kSystem if this computer's own disk fails; nothing has changed then.
Result<ProvisioningReport> provision(const ProvisionOrder& order, SettingsStore* store);

/// Puts the previous settings into use again. Errors: those of SettingsStore::restore().
Result<ProvisioningReport> restore_settings(const std::string& at, SettingsStore* store,
                                            SettingsOf of = SettingsOf::kMuseum);

}  // namespace cyclorama::provision

// SPDX-License-Identifier: Apache-2.0
/// From a stick to settings in use, or to a reason why not.
#pragma once

#include <filesystem>
#include <string>

#include "common/base/result.h"
#include "kiosk/provision/provisioning_report.h"
#include "kiosk/provision/settings_check.h"
#include "kiosk/provision/settings_store.h"

namespace cyclorama {

struct ProvisionOrder {
  std::filesystem::path from;
  SettingsCheck check{};
  FolderLimits limits{};
  bool only_check = false;  ///< Says what would come of it, and changes nothing.
  std::string at;           ///< The time, as reports tell it.
};

/// Copies, checks what was copied, and takes it into use only if nothing is wrong. Bad settings are no error but a
/// report with problems. kSystem  this computer's own disk: nothing has changed.
Result<ProvisioningReport> provision(const ProvisionOrder& order, SettingsStore* store);

/// The settings of before. Errors of SettingsStore::restore().
Result<ProvisioningReport> restore_settings(const std::string& at, SettingsStore* store,
                                            SettingsOf of = SettingsOf::kMuseum);

}  // namespace cyclorama

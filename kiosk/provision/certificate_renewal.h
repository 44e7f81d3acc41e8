// SPDX-License-Identifier: Apache-2.0
/// Puts a museum's next certificate into use, which cyclorama-renew-certificate got from the farm.
#pragma once

#include <filesystem>
#include <optional>

#include "common/base/result.h"
#include "kiosk/provision/provisioning_report.h"
#include "kiosk/provision/sandboxed_check.h"
#include "kiosk/provision/settings_check.h"
#include "kiosk/provision/settings_store.h"

namespace cyclorama::provision {

struct CertificateOrder {
  std::filesystem::path from;  ///< Folder with certificate.crt and key.pem, of a user without rights.
  SettingsCheck check{};
  std::optional<SandboxedCheck> sandbox{};  ///< Checks in another process instead of this one.
};

/// Copies the settings in use, exchanges certificate and key in the copy, checks all of it, and puts it into use in
/// their place. Nothing restarts: programs read their certificates again. Writes the new end into `report`, which is
/// that of the settings in use.
///
/// Errors: kNotFound if no settings are in use, or they name no certificate; kBadData if the result has problems, or
/// ends no later than what is in use: it stays in use then; those of copy_folder() and kSystem.
Status renew_certificate(const CertificateOrder& order, SettingsStore* store, ProvisioningReport* report);

}  // namespace cyclorama::provision

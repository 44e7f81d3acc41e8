// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "common/base/result.h"
#include "kiosk/setup/setup_fields.h"

namespace cyclorama::setup {

/// Files by name, such as "site.toml" or "tls/key.pem".
using SettingsFiles = std::map<std::string, std::string>;

/// Returns the files that one step changes, to be laid over the settings in use. `in_use` has the texts of site.toml and
/// calibrator.toml, as far as they exist; `brought` the files that people brought for this step. Errors:
/// kInvalidArgument with the step's first problem; those of with_value() and with_table() if a file in use cannot be
/// changed.
Result<SettingsFiles> offer_of(const std::string& step, const std::map<std::string, StepDraft>& all,
                               const SetupFacts& facts, const SettingsFiles& in_use, const SettingsFiles& brought);

/// Replaces the folder by one with these files, which this user alone can open. Errors: kSystem.
Status write_offer(const std::filesystem::path& folder, const SettingsFiles& files);

/// Returns what the fields of a step are before anybody has typed: the settings in use, else sensible ones.
[[nodiscard]] Fields first_fields(const std::string& step, const SettingsFiles& in_use, const SetupFacts& facts);

}  // namespace cyclorama::setup

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/base/result.h"
#include "renderfarm/coordinator/coordinator.h"

namespace cyclorama::coordinator {

/// Reads farm.toml; docs/reference/settings.md lists its keys.
///
/// Errors as Config's, and kInvalidArgument as validate(CoordinatorOptions).
Result<CoordinatorOptions> read_coordinator_config(const std::filesystem::path& path);
/// The same of a text; `name` stands in errors for the file's.
Result<CoordinatorOptions> parse_coordinator_config(std::string_view text, const std::string& name);

/// NAME=PATH, as on the command line. kInvalidArgument.
Result<FarmScene> parse_farm_scene(const std::string& text);

}  // namespace cyclorama::coordinator

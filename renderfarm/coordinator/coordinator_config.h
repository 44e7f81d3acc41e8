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
/// Errors: those of Config; kInvalidArgument under the conditions of validate(CoordinatorOptions).
Result<CoordinatorOptions> read_coordinator_config(const std::filesystem::path& path);
/// Reads the same settings from a text; errors quote `name` as the file name.
Result<CoordinatorOptions> parse_coordinator_config(std::string_view text, const std::string& name);

/// Parses NAME=PATH from the command line. Errors: kInvalidArgument.
Result<FarmScene> parse_farm_scene(const std::string& text);

}  // namespace cyclorama::coordinator

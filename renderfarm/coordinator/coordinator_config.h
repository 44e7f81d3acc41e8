// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/base/result.h"
#include "renderfarm/coordinator/coordinator.h"

namespace cyclorama {

/// Reads farm.toml; docs/reference/settings.md lists its keys.
///
/// Errors as Config's, and kInvalidArgument as validate(HeadOptions).
Result<HeadOptions> read_head_config(const std::filesystem::path& path);
/// The same of a text; `name` stands in errors for the file's.
Result<HeadOptions> parse_head_config(std::string_view text, const std::string& name);

/// NAME=PATH, as on the command line. kInvalidArgument.
Result<FarmScene> parse_farm_scene(const std::string& text);

}  // namespace cyclorama

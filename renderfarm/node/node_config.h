// SPDX-License-Identifier: Apache-2.0
/// Reads node.toml; docs/reference/settings.md lists its keys.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/base/result.h"
#include "renderfarm/node/farm_node.h"

namespace cyclorama::node {

inline constexpr int kMaxNodeThreads = 4096;
inline constexpr double kMinMemoryGib = 0.25;
inline constexpr double kMaxMemoryGib = 65536.0;
inline constexpr double kMaxCacheGib = 1e6;

/// Reads the settings file; missing values are empty or 0, and complete() fills them in.
/// Errors: those of Config: kNotFound, kSystem or kBadData, with file, line and remedy.
Result<FarmNodeOptions> read_node_config(const std::filesystem::path& path);
/// Reads the same settings from a text; errors quote `name` as the file name.
Result<FarmNodeOptions> parse_node_config(std::string_view text, const std::string& name);

/// Fills in the host's name and number of threads where they are missing. Errors: kInvalidArgument if there is no
/// coordinator.
/// no coordinator.
Result<FarmNodeOptions> complete(FarmNodeOptions options);

[[nodiscard]] std::uint64_t bytes_of_gib(double gib);

}  // namespace cyclorama::node

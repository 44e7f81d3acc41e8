// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "common/base/result.h"
#include "common/config/config.h"

namespace cyclorama::watch {

/// Ways to watch the farm; all are off by default.
struct WatchOptions {
  std::string address{};  ///< HTTP address, such as "[::1]:7404". Empty: nothing listens.
  /// File whose first line is the token. Required unless only this machine can reach the address.
  std::filesystem::path token_file{};
  std::filesystem::path metrics_file{};  ///< Written every ten seconds. Empty: no file.
};

/// Reads the table [watch] of farm.toml. Its keys are named like the fields above and are optional. Relative paths
/// start from `folder`.
[[nodiscard]] WatchOptions read_watch_options(ConfigTable table, const std::filesystem::path& folder);

/// Checks the options. Errors: kInvalidArgument for a malformed address, or one that others can reach while there is no
/// token.
Status validate(const WatchOptions& options);

}  // namespace cyclorama::watch

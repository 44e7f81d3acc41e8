// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "common/base/result.h"
#include "common/config/config.h"

namespace cyclorama {

/// How the farm may be watched; all of it is off unless asked for.
struct WatchOptions {
  std::string address{};  ///< Of HTTP: "[::1]:7404". Empty: nothing listens.
  std::filesystem::path
      token_file{};  ///< Its first line lets in. Needed unless only this machine can reach the address.
  std::filesystem::path metrics_file{};  ///< Written every ten seconds. Empty: no file.
};

/// [watch] of farm.toml; the keys have the names above, each may be left out.
/// Files are sought in `folder`.
[[nodiscard]] WatchOptions read_watch_options(ConfigTable table, const std::filesystem::path& folder);

/// kInvalidArgument  an address that is none, or that others can reach while there is no token.
Status validate(const WatchOptions& options);

}  // namespace cyclorama

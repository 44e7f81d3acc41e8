// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/base/result.h"
#include "common/config/config.h"

namespace cyclorama {

/// How the farm may be watched; all of it is off unless asked for.
struct WatchOptions {
  std::string address{};       ///< Of HTTP: "[::1]:7404". Empty: nothing listens.
  std::string token_file{};    ///< Its first line lets in. Needed unless only this machine can reach the address.
  std::string metrics_file{};  ///< Written every ten seconds. Empty: no file.
};

/// [watch] of farm.toml; the keys have the names above, each may be left out.
[[nodiscard]] WatchOptions read_watch_options(ConfigTable table);

/// kInvalidArgument  an address that is none, or that others can reach while there is no token.
Status validate(const WatchOptions& options);

}  // namespace cyclorama

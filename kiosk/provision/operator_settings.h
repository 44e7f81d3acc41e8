// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace cyclorama::provision {

/// operator.toml as it comes on a USB stick. It is never stored: the settings in use contain the PIN's hash instead.
///
///   # operator.toml
///   pin = "40 17 73"      # Spaces are ignored. Without it, the page answers on this computer only.
struct OperatorSettings {
  std::optional<std::string> pin;
};

/// Parses operator.toml. `name` stands for the file in errors, which never contain the PIN. Errors: those of
/// Config::read() and check_pin().
Result<OperatorSettings> parse_operator_settings(std::string_view text, std::string name);

}  // namespace cyclorama::provision

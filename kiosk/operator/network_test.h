// SPDX-License-Identifier: Apache-2.0
/// Checks whether the farm can be reached from here, and where the connection fails if not.
#pragma once

#include <string>
#include <vector>

#include "common/base/clock.h"
#include "kiosk/operator/checks.h"

namespace cyclorama::operations {

/// Checks in this order: whether this computer has an outside address; whether the name server answers (if the farm has
/// a name); whether each coordinator of the farm accepts a connection, and how long that takes; whether the clock is
/// set. Returns one Check for each, with its remedy. Connections are closed at once without sending anything. Blocks at
/// most `longest` for each address.
[[nodiscard]] std::vector<Check> test_network(const std::vector<std::string>& farm, const MachineFacts& machine,
                                              Duration longest = std::chrono::seconds(3));

}  // namespace cyclorama::operations

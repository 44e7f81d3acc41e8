// SPDX-License-Identifier: Apache-2.0
/// Whether the farm can be reached from here, and where it ends if not.
#pragma once

#include <string>
#include <vector>

#include "common/base/clock.h"
#include "kiosk/operator/checks.h"

namespace cyclorama {

/// Asks, in this order: does this computer have an address of the outer world; does the name server answer (where the
/// farm has a name); does each head of the farm take a connection, and how long is the way; is the clock set. One Check
/// for each, with its remedy. Connections are closed at once, and nothing is said on them. Blocks, at most `longest`
/// for each address.
[[nodiscard]] std::vector<Check> test_network(const std::vector<std::string>& farm, const MachineFacts& machine,
                                              Duration longest = std::chrono::seconds(3));

}  // namespace cyclorama

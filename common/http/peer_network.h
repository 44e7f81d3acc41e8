// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace cyclorama {

/// Returns the part of a client's address that one household or hall shares: "192.0.2.7", or the first half of an IPv6
/// address, "2001:db8:0:1". Pure.
[[nodiscard]] std::string peer_network(const std::string& address);

}  // namespace cyclorama

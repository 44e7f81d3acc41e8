// SPDX-License-Identifier: Apache-2.0
/// Where a process listens, as people write it: "[::1]:7401", "farm.example.org:7401", "unix:/run/farm/inspect.sock".
#pragma once

#include <string>

#include "common/base/result.h"

namespace cyclorama {

struct Address {
  std::string host{};  ///< Without brackets.
  int port = 0;
};

/// HOST:PORT. kInvalidArgument  another form; an IPv6 address needs its brackets.
Result<Address> parse_address(const std::string& text);

/// A socket in the file system, by its absolute path; whoever may open the file may dial.
[[nodiscard]] bool is_unix_socket(const std::string& text);

/// That only this machine can reach it: localhost, 127.0.0.0/8, ::1, or a Unix socket.
[[nodiscard]] bool is_loopback(const std::string& text);

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
/// Addresses as people write them: "[::1]:7401", "farm.example.org:7401", "unix:/run/farm/inspect.sock".
#pragma once

#include <string>

#include "common/base/result.h"

namespace cyclorama {

struct Address {
  std::string host{};  ///< Without brackets.
  int port = 0;
};

/// Parses HOST:PORT. Errors: kInvalidArgument if the text has another form; an IPv6 address must be in brackets.
Result<Address> parse_address(const std::string& text);

/// True for a socket in the file system, given by its absolute path. Every user who may open that file may connect.
[[nodiscard]] bool is_unix_socket(const std::string& text);

/// True if only this machine can reach the address: localhost, 127.0.0.0/8, ::1, or a Unix socket.
[[nodiscard]] bool is_loopback(const std::string& text);

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
/// The processes that the operator watches, and their addresses.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::operations {

struct Endpoint {
  std::string name;     ///< Key in pages, files and metrics: "tour", "display", "simulated-room".
  std::string address;  ///< "[::1]:7403".
};

/// Parses "tour=[::1]:7403". Errors: kInvalidArgument for any other form.
Result<Endpoint> parse_endpoint(std::string_view text);

/// Combines the options (`--watch NAME=ADDRESS`, which take precedence) and, if given, a file of [[watch]] tables with
/// name and address. Errors: kInvalidArgument if a name occurs twice, or there are no endpoints or more than
/// kMaxEndpoints; others are those of Config::read().
Result<std::vector<Endpoint>> gather_endpoints(const std::vector<std::string>& watches,
                                               const std::optional<std::filesystem::path>& file);
inline constexpr std::size_t kMaxEndpoints = 24;

}  // namespace cyclorama::operations

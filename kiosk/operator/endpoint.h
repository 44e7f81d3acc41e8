// SPDX-License-Identifier: Apache-2.0
/// Which processes the operator looks at, and where they listen.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"

namespace cyclorama {

struct Endpoint {
  std::string name;     ///< "tour", "display", "simulated-room": its key in pages, files and metrics.
  std::string address;  ///< "[::1]:7403".
};

/// "tour=[::1]:7403". kInvalidArgument  another form.
Result<Endpoint> parse_endpoint(std::string_view text);

/// From options (`--watch NAME=ADDRESS`, which win) and, if given, a file of [[watch]] tables with name and address.
/// kInvalidArgument  a name twice, none at all, or more than kMostEndpoints.     Else as Config::read().
Result<std::vector<Endpoint>> gather_endpoints(const std::vector<std::string>& watches,
                                               const std::optional<std::filesystem::path>& file);
inline constexpr std::size_t kMostEndpoints = 24;

}  // namespace cyclorama

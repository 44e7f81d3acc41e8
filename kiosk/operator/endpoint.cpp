// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/endpoint.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/text.h"
#include "common/config/config.h"

namespace cyclorama::operations {
namespace {

/// True for a name that is safe as a file name, a label and a part of a URL.
bool is_name(std::string_view text) {
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
  };
  return !text.empty() && text.size() <= 60 && std::all_of(text.begin(), text.end(), is_plain);
}

Status add(Endpoint endpoint, std::vector<Endpoint>* endpoints) {
  for (const Endpoint& other : *endpoints) {
    if (other.name != endpoint.name) continue;
    return Error(ErrorCode::kInvalidArgument, fmt::format("'{}' is watched twice; give each its own name", other.name));
  }
  if (endpoints->size() >= kMaxEndpoints) {
    return Error(ErrorCode::kInvalidArgument, fmt::format("more than {} processes are watched", kMaxEndpoints));
  }
  endpoints->push_back(std::move(endpoint));
  return Done{};
}

}  // namespace

Result<Endpoint> parse_endpoint(std::string_view text) {
  const std::size_t equals = text.find('=');
  const std::string_view name = text.substr(0, equals);
  if (equals == std::string_view::npos || !is_name(name) || equals + 1 == text.size()) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("'{}' is not NAME=ADDRESS, such as tour=[::1]:7403", printable(text)));
  }
  return Endpoint{std::string(name), std::string(text.substr(equals + 1))};
}

Result<std::vector<Endpoint>> gather_endpoints(const std::vector<std::string>& watches,
                                               const std::optional<std::filesystem::path>& file) {
  std::vector<Endpoint> endpoints;
  for (const std::string& watch : watches) {
    TRY_ASSIGN(Endpoint endpoint, parse_endpoint(watch));
    TRY(add(std::move(endpoint), &endpoints));
  }
  if (file) {
    TRY_ASSIGN(Config config, Config::read(*file));
    ConfigTable root = config.root();
    std::vector<Endpoint> listed;
    for (ConfigTable& table : root.tables("watch")) {
      Endpoint endpoint{table.text("name"), table.text("address")};
      if (!is_name(endpoint.name)) table.refuse("name", "must be letters, digits, '-' and '_'");
      listed.push_back(std::move(endpoint));
    }
    TRY(config.finish());
    const std::vector<Endpoint> given = endpoints;
    for (Endpoint& endpoint : listed) {
      const bool replaced =
          std::any_of(given.begin(), given.end(), [&](const Endpoint& other) { return other.name == endpoint.name; });
      if (!replaced) TRY(add(std::move(endpoint), &endpoints));
    }
  }
  if (endpoints.empty()) {
    return Error(ErrorCode::kInvalidArgument, "nothing to watch; give --watch NAME=ADDRESS, such as tour=[::1]:7403");
  }
  return endpoints;
}

}  // namespace cyclorama::operations

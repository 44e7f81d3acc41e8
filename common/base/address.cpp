// SPDX-License-Identifier: Apache-2.0
#include "common/base/address.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/text.h"

namespace cyclorama {

Result<Address> parse_address(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  const std::string_view digits = colon == std::string::npos ? "" : std::string_view(text).substr(colon + 1);
  const long long port = parse_integer(digits).value_or(-1);
  std::string host = text.substr(0, std::min(colon, text.size()));
  const bool bracketed = host.size() > 2 && host.front() == '[' && host.back() == ']';
  if (bracketed) host = host.substr(1, host.size() - 2);
  const bool malformed = !bracketed && host.find_first_of(":[]") != std::string::npos;
  if (port < 0 || port > 65535 || host.empty() || malformed) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("'{}' is not an address; write HOST:PORT, such as [::1]:7401", printable(text)));
  }
  return Address{std::move(host), static_cast<int>(port)};
}

bool is_unix_socket(const std::string& text) { return text.starts_with("unix:/"); }

bool is_loopback(const std::string& text) {
  if (is_unix_socket(text)) return true;
  const auto address = parse_address(text);
  if (!address) return false;
  const std::string& host = address->host;
  return host == "localhost" || host == "::1" ||
         (host.starts_with("127.") && host.find_first_not_of("0123456789.") == std::string::npos);
}

}  // namespace cyclorama

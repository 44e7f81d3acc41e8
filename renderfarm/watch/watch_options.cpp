// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/watch/watch_options.h"

#include <fmt/format.h>

#include "common/base/address.h"

namespace cyclorama::watch {

WatchOptions read_watch_options(ConfigTable table, const std::filesystem::path& folder) {
  const auto file = [&](const char* key) {
    const std::string text = table.text(key, "");
    return text.empty() ? std::filesystem::path() : folder / text;
  };
  return {table.text("address", ""), file("token_file"), file("metrics_file")};
}

Status validate(const WatchOptions& options) {
  if (options.address.empty()) return Done{};
  TRY(parse_address(options.address));
  if (options.token_file.empty() && !is_loopback(options.address)) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("watch.address '{}' can be reached from other machines: name a token_file, or listen on "
                             "[::1] only",
                             options.address));
  }
  return Done{};
}

}  // namespace cyclorama::watch

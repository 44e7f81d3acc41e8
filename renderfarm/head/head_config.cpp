// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/head/head_config.h"

#include <fmt/format.h>

#include "common/base/text.h"
#include "common/config/config.h"

namespace cyclorama {

Result<HeadOptions> read_head_config(const std::filesystem::path& path) {
  TRY_ASSIGN(Config config, Config::read(path));
  ConfigTable root = config.root();
  HeadOptions options;
  options.museums = root.text("museums");
  options.nodes = root.text("nodes");
  options.inspect = root.text("inspect", "");
  options.strategy = *balance_strategy_of(root.choice("balance", {"pbt", "equal"}, "pbt"));
  for (ConfigTable& scene : root.tables("scene")) options.scenes.push_back({scene.text("name"), scene.text("path")});
  if (root.has("limits")) {
    const HeadLimits defaults;
    ConfigTable limits = root.table("limits");
    options.limits.nodes =
        static_cast<std::size_t>(limits.integer("nodes", {1, 4096}, static_cast<int>(defaults.nodes)));
    options.limits.sessions =
        static_cast<std::size_t>(limits.integer("visits", {1, 1024}, static_cast<int>(defaults.sessions)));
    options.limits.picture_px = static_cast<std::int64_t>(
        1e6 * limits.number("picture_megapixels", {0.01, 269.0}, 1e-6 * static_cast<double>(defaults.picture_px)));
  }
  TRY(config.finish());
  if (const Status fine = validate(options); !fine) {
    return Error(fine.error()).while_doing(path.string());
  }
  return options;
}

Result<FarmScene> parse_farm_scene(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("--scene '{}' is not NAME=PATH, such as grotto=/srv/scenes/grotto", printable(text)));
  }
  return FarmScene{text.substr(0, equals), text.substr(equals + 1)};
}

}  // namespace cyclorama

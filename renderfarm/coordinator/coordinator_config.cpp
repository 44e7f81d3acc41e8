// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/coordinator_config.h"

#include <fmt/format.h>

#include "common/base/text.h"
#include "common/config/config.h"

namespace cyclorama::coordinator {
namespace {

trust::TrustOptions read_trust(ConfigTable& root, const std::filesystem::path& folder) {
  trust::TrustOptions trust;
  const auto file = [&](ConfigTable& table, const char* key, std::optional<std::string> fallback = std::nullopt) {
    const std::string text = table.text(key, std::move(fallback));
    return text.empty() ? std::filesystem::path() : folder / text;
  };
  trust.insecure = root.flag("insecure", false);
  trust.museums = file(root, "museums_file", "");
  trust.audit = file(root, "audit", "");
  if (root.has("tls")) {
    ConfigTable tls = root.table("tls");
    trust.tls = TlsFiles{file(tls, "authority"), file(tls, "certificate"), file(tls, "key")};
    trust.revoked = file(tls, "revoked", "");
  }
  return trust;
}

Result<CoordinatorOptions> options_of(Config config, const std::string& name) {
  ConfigTable root = config.root();
  CoordinatorOptions options;
  options.museums = root.text("museums");
  options.nodes = root.text("nodes");
  options.inspect = root.text("inspect", "");
  options.strategy = *balance::balance_strategy_of(
      root.choice("balance", {"cost-map-stealing", "cost-map", "pbt-leaves", "pbt", "equal"}, "cost-map-stealing"));
  for (ConfigTable& scene : root.tables("scene")) {
    FarmScene& added = options.scenes.emplace_back();
    added.name = scene.text("name");
    added.path = scene.text("path");
    added.on_coordinator = scene.choice("on", {"nodes", "coordinator"}, "nodes") == "coordinator";
  }
  if (root.has("distribution")) {
    constexpr double kBytesPerMbit = 1e6 / 8.0;
    ConfigTable distribution = root.table("distribution");
    options.distribution.digests = distribution.text("digests", "");
    options.distribution.files.bytes_per_second =
        kBytesPerMbit * distribution.number("limit_mbit_per_s", {0.0, 1e6}, 0.0);
    options.distribution.files.streams = static_cast<std::size_t>(
        distribution.integer("files", {1, 1024}, static_cast<int>(FileServer::Options{}.streams)));
  }
  if (root.has("updates")) options.updates = root.table("updates").text("folder");
  if (root.has("renewals")) options.renewals = root.table("renewals").text("folder");
  if (root.has("watch")) {
    options.watch = watch::read_watch_options(root.table("watch"), std::filesystem::path(name).parent_path());
  }
  if (root.has("limits")) {
    const CoordinatorLimits defaults;
    ConfigTable limits = root.table("limits");
    options.limits.nodes =
        static_cast<std::size_t>(limits.integer("nodes", {1, 4096}, static_cast<int>(defaults.nodes)));
    limits.refuse_renamed("visits", "sessions");
    options.limits.sessions =
        static_cast<std::size_t>(limits.integer("sessions", {1, 1024}, static_cast<int>(defaults.sessions)));
    options.limits.picture_px = static_cast<std::int64_t>(
        1e6 * limits.number("picture_megapixels", {0.01, 269.0}, 1e-6 * static_cast<double>(defaults.picture_px)));
  }
  options.trust = read_trust(root, std::filesystem::path(name).parent_path());
  TRY(config.finish());
  if (const Status fine = validate(options); !fine) {
    return Error(fine.error()).while_doing(name);
  }
  return options;
}

}  // namespace

Result<CoordinatorOptions> read_coordinator_config(const std::filesystem::path& path) {
  TRY_ASSIGN(Config config, Config::read(path));
  return options_of(std::move(config), path.string());
}

Result<CoordinatorOptions> parse_coordinator_config(std::string_view text, const std::string& name) {
  TRY_ASSIGN(Config config, Config::parse(text, name));
  return options_of(std::move(config), name);
}

Result<FarmScene> parse_farm_scene(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("--scene '{}' is not NAME=PATH, such as grotto=/srv/scenes/grotto", printable(text)));
  }
  return FarmScene{text.substr(0, equals), text.substr(equals + 1)};
}

}  // namespace cyclorama::coordinator

// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/node_config.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <thread>
#include <utility>

#include "common/config/config.h"

namespace cyclorama::node {
namespace {

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "node";
}

/// Reads the table `tls`. Relative paths start from the folder of node.toml.
TlsFiles read_tls(ConfigTable tls, const std::filesystem::path& folder) {
  return {folder / tls.text("authority"), folder / tls.text("certificate"), folder / tls.text("key")};
}

Result<FarmNodeOptions> options_of(Config config, const std::filesystem::path& folder) {
  ConfigTable root = config.root();
  FarmNodeOptions options;
  root.refuse_renamed("heads", "coordinators");
  root.refuse_renamed("head", "coordinator");
  options.coordinators = root.texts("coordinators", std::vector<std::string>{});
  if (root.has("coordinator")) {
    if (root.has("coordinators")) root.refuse("coordinator", "stands beside 'coordinators'; write all of them there");
    options.coordinators = {root.text("coordinator")};
  }
  options.name = root.text("name", "");
  options.threads = root.integer("threads", {0, kMaxNodeThreads}, 0);
  if (root.has("memory_gib")) {
    options.memory_limit_bytes = bytes_of_gib(root.number("memory_gib", {kMinMemoryGib, kMaxMemoryGib}));
  }
  options.cache.folder = root.text("cache", "");
  options.cache.limit_bytes = bytes_of_gib(root.number("cache_gib", {0.0, kMaxCacheGib}, 0.0));
  options.computes_light = root.flag("compute_light", true);
  if (root.has("tls")) options.tls = read_tls(root.table("tls"), folder);
  TRY(config.finish());
  return options;
}

}  // namespace

Result<FarmNodeOptions> read_node_config(const std::filesystem::path& path) {
  TRY_ASSIGN(Config config, Config::read(path));
  return options_of(std::move(config), path.parent_path());
}

Result<FarmNodeOptions> parse_node_config(std::string_view text, const std::string& name) {
  TRY_ASSIGN(Config config, Config::parse(text, name));
  return options_of(std::move(config), {});
}

Result<FarmNodeOptions> complete(FarmNodeOptions options) {
  if (options.coordinators.empty()) {
    return Error(ErrorCode::kInvalidArgument,
                 "no coordinator is given; write --coordinator [::1]:7402, or 'coordinators' in node.toml");
  }
  if (options.name.empty()) options.name = host_name();
  if (options.threads == 0) options.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  return options;
}

std::uint64_t bytes_of_gib(double gib) { return static_cast<std::uint64_t>(std::llround(gib * (1 << 30))); }

}  // namespace cyclorama::node

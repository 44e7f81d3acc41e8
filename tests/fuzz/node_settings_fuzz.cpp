// SPDX-License-Identifier: Apache-2.0
/// node.toml.
#include <cstddef>
#include <cstdint>

#include "common/base/check.h"
#include "renderfarm/node/node_config.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  const auto options = node::parse_node_config({reinterpret_cast<const char*>(data), size}, "node.toml");
  if (!options) {
    CHECK(options.error().message().find("node.toml") != std::string::npos);
    return 0;
  }
  CHECK(options->threads >= 0 && options->threads <= node::kMaxNodeThreads);
  CHECK(options->memory_limit_bytes <= node::bytes_of_gib(node::kMaxMemoryGib));
  CHECK(options->cache.limit_bytes <= node::bytes_of_gib(node::kMaxCacheGib));
  const auto whole = node::complete(*options);
  CHECK(whole.has_value() == !options->coordinators.empty());
  CHECK(!whole || (whole->threads > 0 && !whole->name.empty()));
  return 0;
}

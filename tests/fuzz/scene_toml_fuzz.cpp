// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "common/base/check.h"
#include "renderfarm/scene/scene_package.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto package = cyclorama::scene::parse_scene_package(text, "scene.toml", "/proc/self");
  if (package) CHECK(!package->geometry.empty());
  return 0;
}

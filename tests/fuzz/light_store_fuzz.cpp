// SPDX-License-Identifier: Apache-2.0
/// light.store: whatever is accepted can be read at each of its triangles.
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "common/base/check.h"
#include "renderfarm/light/light_file.h"

namespace {

/// Reads every triangle for which the file has a grid.
void read_grids(const cyclorama::light::LightStore& store) {
  for (std::size_t i = 0; i < store.surfaces.size(); ++i) {
    for (const int side : {0, 1}) {
      const std::vector<std::uint32_t>& grids = store.surfaces[i].sides[static_cast<std::size_t>(side)].grids;
      for (std::uint32_t t = 0; t < grids.size(); ++t) {
        if (grids[t] == cyclorama::light::TriangleGrid::kBase) continue;
        for (const float u : {0.0f, 0.3f, 1.0f}) {
          (void)store.at({i, side, t, {0, 0, 0}, {0.5f * (1.0f - u), u, 0.5f * (1.0f - u)}});
        }
      }
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  // The checksum would hide everything behind it from the fuzzer, so it is made to match.
  std::vector<std::byte> bytes(size);
  if (size > 0) std::memcpy(bytes.data(), data, size);
  if (size >= sizeof(XXH64_hash_t)) {
    const std::size_t content = size - sizeof(XXH64_hash_t);
    const XXH64_hash_t checksum = XXH3_64bits(data, content);
    std::memcpy(bytes.data() + content, &checksum, sizeof(checksum));
  }
  const auto store = light::parse_light_file(bytes, "light.store");
  if (!store) return 0;
  const auto again = light::parse_light_file(light::light_file_bytes(*store), "again");
  CHECK(again.has_value());
  read_grids(*store);
  for (const light::LightStore& group : store->groups) read_grids(group);
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
/// A LightStore in a file, `light.store` in a scene's folder:
///
///   "CYCLIGHT"  version u32  placements u32  scene key 2 x u64  unit f32  length of the settings u32, settings
///   check: the fields of LightCheck in their order, 4 bytes each
///   number of groups of lamps u32, for each its unit f32
///   for the light without groups, then for that of each group:
///   for each placement:  base_per_triangle u32, then for each side the lengths of base, directions, grids and samples,
///     4 x u32
///   for each placement and side:  base, directions, grids, samples, 4 bytes each;  errors of base and samples, 1 byte
///     each
///   XXH3 (64 bits) of all preceding bytes
///
/// Everything is little-endian.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/light/light_store.h"

namespace cyclorama::light {

inline constexpr const char* kLightFileName = "light.store";

[[nodiscard]] std::vector<std::byte> light_file_bytes(const LightStore& store);

/// Parses the bytes of a file; `name` identifies the file in errors. Even if the bytes are malicious, the store can be
/// read safely at every triangle for which it has samples. check_fits() checks whether it belongs to a scene. Errors:
/// kBadData, with the remedy.
Result<LightStore> parse_light_file(std::span<const std::byte> bytes, std::string_view name);

/// Reads a file. Errors: kNotFound if there is none; kSystem; those of parse_light_file().
Result<LightStore> read_light_file(const std::filesystem::path& path);
/// Writes the file completely or not at all.
Status write_light_file(const std::filesystem::path& path, const LightStore& store);

/// Vertex and triangle counts of a placed mesh, which determine the lengths of the arrays of its light.
struct PlacementSize {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
};
/// Checks that the store belongs to the scene with this key and these placements. Errors: kBadData.
Status check_fits(const LightStore& store, const SceneKey& scene, const std::vector<PlacementSize>& placements,
                  std::string_view name);

}  // namespace cyclorama::light

// SPDX-License-Identifier: Apache-2.0
// Damages a valid compressed square and its description in the file. The first three bytes choose a mode, a filter and
// a stride; each following group of three is a part, an offset and a change there.
#include <array>

#include "common/base/check.h"
#include "tests/unit/renderfarm/scene/meshopt_builder.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::array<const char*, 4> kModes = {"ATTRIBUTES", "TRIANGLES", "INDICES", "OTHER"};
  constexpr std::array<const char*, 5> kFilters = {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR"};
  static const cyclorama::scene::MeshoptSquare kWhole = cyclorama::scene::compressed_meshopt_square();
  if (size < 3) return 0;
  cyclorama::scene::MeshoptSquare damaged = kWhole;
  for (std::size_t i = 3; i + 2 < size; i += 3) {
    std::vector<std::uint8_t>& part = data[i] % 2 == 0 ? damaged.positions : damaged.indices;
    part[data[i + 1] % part.size()] ^= data[i + 2];
  }
  cyclorama::scene::GltfBuilder file = cyclorama::scene::meshopt_file(damaged);
  auto& changed = file.json["bufferViews"][data[0] / 4 % 2]["extensions"]["EXT_meshopt_compression"];
  if (data[0] >= 8) {
    changed["mode"] = kModes[data[0] % 4];
    changed["filter"] = kFilters[data[1] % 5];
    changed["count"] = data[1] / 4;
    changed["byteStride"] = data[2];
  }
  cyclorama::scene::ImportLimits limits;
  limits.memory_bytes = std::size_t{64} << 20;
  const auto model = file.import(limits);
  if (!model) return 0;
  for (const cyclorama::scene::Mesh& mesh : model->meshes) {
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t corner : triangle) CHECK(corner < mesh.positions.size());
    }
  }
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
// Damages valid Draco data, since a fuzzer that started from nothing would never get past its entropy coder. The first
// byte selects the method; each following group of three bytes is an offset and a change there.
#include <array>

#include "tests/unit/renderfarm/scene/draco_builder.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::array<std::vector<std::uint8_t>, 2> kWhole = {
      cyclorama::scene::compressed_square(draco::MESH_SEQUENTIAL_ENCODING),
      cyclorama::scene::compressed_square(draco::MESH_EDGEBREAKER_ENCODING)};
  if (size == 0) return 0;
  std::vector<std::uint8_t> damaged = kWhole[data[0] % 2];
  for (std::size_t i = 1; i + 2 < size; i += 3) {
    const std::size_t offset = data[i] * std::size_t{256} + data[i + 1];
    damaged[offset % damaged.size()] ^= data[i + 2];
  }
  cyclorama::scene::ImportLimits limits;
  limits.memory_bytes = std::size_t{64} << 20;
  const auto model = cyclorama::scene::draco_file(damaged).import(limits);
  if (model) {
    for (const auto& t : model->meshes.at(0).triangles) {
      for (const std::uint32_t corner : t) CHECK(corner < model->meshes[0].positions.size());
    }
  }
  return 0;
}

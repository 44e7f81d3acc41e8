// SPDX-License-Identifier: Apache-2.0
/// The truth of a simulated museum as text; an accepted text is written and read again.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "drivers/simulated/museum/truth.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  const auto truth = simulated::MuseumTruth::parse({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (truth && !std::holds_alternative<MeshWall>(truth->wall))
    static_cast<void>(simulated::MuseumTruth::parse(truth->text(), "again"));
  return 0;
}

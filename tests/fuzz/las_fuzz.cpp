// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>

#include "renderfarm/scene/model.h"
#include "tests/support/memory_file.h"
#include "tests/support/model_invariants.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  const MemoryFile file({reinterpret_cast<const char*>(data), size});
  const auto model = scene::import_las(file.path(), scene::ImportLimits{.memory_bytes = std::size_t{64} << 20});
  if (model) CHECK(broken_promise(*model).empty());
  return 0;
}

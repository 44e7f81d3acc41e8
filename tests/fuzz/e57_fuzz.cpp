// SPDX-License-Identifier: Apache-2.0
// The first byte chooses whether the rest is a file or the content of pages, whose checksums are then right.
#include <cstddef>
#include <cstdint>

#include "renderfarm/scene/model.h"
#include "tests/support/e57_builder.h"
#include "tests/support/memory_file.h"
#include "tests/support/model_invariants.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  std::string bytes(reinterpret_cast<const char*>(data), size);
  if (!bytes.empty() && bytes[0] != 'A') bytes = e57_pages_of(bytes.replace(0, 1, "A"));
  const MemoryFile file(bytes);
  const auto model = scene::import_e57(file.path(), scene::ImportLimits{.memory_bytes = std::size_t{64} << 20});
  if (model) CHECK(broken_promise(*model).empty());
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
/// museums.toml.
#include <cstddef>
#include <cstdint>

#include "common/base/check.h"
#include "renderfarm/trust/grants.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  const auto grants = trust::Grants::parse({reinterpret_cast<const char*>(data), size}, "museums.toml");
  if (!grants) return 0;
  CHECK(grants->find("") == nullptr);
  if (const trust::Grant* const hall = grants->find("hall-3")) {
    CHECK(!hall->scenes.empty() && hall->weight > 0.0 && hall->sessions > 0 && hall->bytes_per_second >= 0.0);
  }
  return 0;
}

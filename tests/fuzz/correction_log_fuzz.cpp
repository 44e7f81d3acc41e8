// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "appliance/healing/correction_log.h"
#include "common/base/check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  const auto read = healing::parse_correction({reinterpret_cast<const char*>(data), size});
  if (!read) return 0;
  // An accepted log can be drawn, written and read again.
  CHECK(read->before.translation().allFinite() && read->after.rotation().coeffs().allFinite());
  const auto back = healing::parse_correction(healing::correction_line(*read));
  CHECK(back && back->kind == read->kind && back->projector == read->projector);
  return 0;
}

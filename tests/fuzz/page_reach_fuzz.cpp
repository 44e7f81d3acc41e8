// SPDX-License-Identifier: Apache-2.0
/// Any text is rejected, or is the same after it was written and read again.
#include <cstddef>
#include <cstdint>
#include <string>

#include "common/base/check.h"
#include "common/reach/page_reach.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;  // NOLINT(google-build-using-namespace)
  const auto reach = parse_page_reach({reinterpret_cast<const char*>(data), size}, "reach.json");
  if (!reach) return 0;
  static_cast<void>(link_of(*reach));
  const auto again = parse_page_reach(to_json(*reach), "reach.json");
  CHECK(again && again->addresses == reach->addresses && again->has_pin == reach->has_pin);
  return 0;
}

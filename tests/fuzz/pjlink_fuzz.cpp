// SPDX-License-Identifier: Apache-2.0
/// Arbitrary PJLink answers of a projector.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "drivers/output/power/pjlink.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  static_cast<void>(output::pjlink::authorise(text, "secret"));
  static_cast<void>(output::pjlink::parse_power(text));
  static_cast<void>(output::pjlink::parse_errors(text));
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "drivers/devices/camera_spec.h"

/// Any line is split into parts of itself, and rejected with a message.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view line(reinterpret_cast<const char*>(data), size);
  const auto spec = cyclorama::devices::CameraSpec::parse(line);
  std::size_t parts = spec.kind.size() + spec.argument.size();
  for (const auto& [key, value] : spec.options) {
    parts += key.size() + value.size();
    const auto number = spec.number(key, value, -1.0, 1.0);
    if (number && !(*number >= -1.0 && *number <= 1.0)) std::abort();
  }
  if (parts > size || spec.refused("no").message().empty()) std::abort();
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
/// Arbitrary answers of a turntable's controller over the serial line.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "common/base/check.h"
#include "drivers/turntable/serial/gcode.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cyclorama;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  gcode::LineCutter lines;
  // Splits the text, as a serial line delivers it.
  for (std::size_t i = 0; i < text.size(); i += 7) {
    lines.add(text.substr(i, 7));
    while (const auto line = lines.next()) {
      CHECK(line->find('\n') == std::string::npos);
      const gcode::Answer answer = gcode::parse_answer(*line, 'X');
      CHECK(std::isfinite(answer.position));
    }
  }
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace cyclorama::display {

/// The format in which pass 1 passes light to pass 2.
enum class Texels {
  /// Linear light in half floats, 64 bits: precise to a 40th of an 8-bit code value with any head. The card filters it.
  kHalves,
  /// Square root of the light in 11, 11 and 10 bits: precise to an 11th of an 8-bit code value on an sRGB head, in blue
  /// to a sixth. The shader converts it to linear light and filters. On a software renderer, this format takes a third
  /// less time, since it needs half the memory.
  kPacked,
};

/// True if GL's `renderer` is one that draws on the processor.
[[nodiscard]] inline bool is_software_renderer(std::string_view renderer) {
  constexpr std::array<std::string_view, 3> kNames{"llvmpipe", "softpipe", "SwiftShader"};
  return std::ranges::any_of(kNames, [&](std::string_view name) { return renderer.find(name) != renderer.npos; });
}

}  // namespace cyclorama::display

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace cyclorama::display {

/// The format in which pass 1 passes light to pass 2.
enum class Texels {
  /// Linear light in half floats, 64 bits: precise to a 40th of a code value of 8 bits with any head. The card filters.
  kHalves,
  /// The light's square root in 11, 11 and 10 bits: precise to an 11th of a code value of 8 bits on an sRGB head, to a
  /// sixth in blue. The shader filters in linear light. On a software renderer, half the memory takes a third less
  /// time.
  kPacked,
};

/// Returns true if the processor draws, by what GL reports as its renderer.
[[nodiscard]] inline bool is_software_renderer(std::string_view renderer) {
  constexpr std::array<std::string_view, 3> kNames{"llvmpipe", "softpipe", "SwiftShader"};
  return std::ranges::any_of(kNames, [&](std::string_view name) { return renderer.find(name) != renderer.npos; });
}

}  // namespace cyclorama::display

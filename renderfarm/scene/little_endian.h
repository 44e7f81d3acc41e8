// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstring>
#include <span>

namespace cyclorama::scene {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they lie in the file");

/// Returns the little-endian number at `offset`. Precondition: the number is inside `bytes`.
template <typename Number>
[[nodiscard]] Number little_endian(std::span<const std::byte> bytes, std::size_t offset) {
  Number value{};
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

}  // namespace cyclorama::scene

// SPDX-License-Identifier: Apache-2.0
#include "common/image/colour.h"

#include <array>
#include <cstddef>

namespace cyclorama {
namespace {

/// Light is divided into kBuckets equal steps. Each step stores the code of its lower edge, which is at most two codes
/// too low.
struct CodeTable {
  static constexpr std::size_t kBuckets = 4096;
  std::array<std::uint8_t, kBuckets + 1> first{};
  std::array<float, 257> min{};  ///< Smallest light of each code; the last entry exceeds all light.

  CodeTable() {
    for (std::size_t code = 1; code < 256; ++code) {
      min[code] = srgb_to_linear((static_cast<float>(code) - 0.5f) / 255.0f);
    }
    min[256] = 2.0f;
    std::uint8_t code = 0;
    for (std::size_t i = 0; i <= kBuckets; ++i) {
      while (static_cast<float>(i) / kBuckets >= min[code + std::size_t{1}]) ++code;
      first[i] = code;
    }
  }
};

}  // namespace

std::uint8_t linear_to_srgb8(float linear) {
  static const CodeTable table;
  if (!(linear > 0.0f)) return 0;  // Also true for NaN.
  if (linear >= 1.0f) return 255;
  std::uint8_t code = table.first[static_cast<std::size_t>(linear * CodeTable::kBuckets)];
  while (linear >= table.min[code + std::size_t{1}]) ++code;
  return code;
}

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace cyclorama {

/// A fuzzer's input, consumed piece by piece as the choices of a program; zeros after its end. Borrows the bytes.
class FuzzInput {
 public:
  explicit FuzzInput(std::span<const std::uint8_t> bytes) : left_(bytes) {}
  FuzzInput(const std::uint8_t* data, std::size_t size) : left_(data, size) {}
  [[nodiscard]] bool is_empty() const { return left_.empty(); }
  std::uint32_t byte() {
    if (left_.empty()) return 0;
    const std::uint8_t value = left_.front();
    left_ = left_.subspan(1);
    return value;
  }
  /// Returns fewer bytes at the end.
  std::span<const std::uint8_t> bytes(std::size_t count) {
    const auto taken = left_.first(std::min(count, left_.size()));
    left_ = left_.subspan(taken.size());
    return taken;
  }

 private:
  std::span<const std::uint8_t> left_;
};

}  // namespace cyclorama

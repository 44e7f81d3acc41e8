// SPDX-License-Identifier: Apache-2.0
/// The results of a piece of work as bytes, exactly as they are in memory, so that a result that comes from a file or
/// another node equals the one that would have been computed here.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/render/vectors.h"

namespace cyclorama::light_baking {

using PieceBytes = std::vector<std::byte>;

class PieceWriter {
 public:
  template <typename Value>
  requires(std::is_arithmetic_v<Value>) void add(Value value) { add_bytes(std::as_bytes(std::span(&value, 1))); }
  void add(const render::Vec3& value) { add_bytes(std::as_bytes(std::span(value.data(), 3))); }
  [[nodiscard]] PieceBytes take() { return std::move(bytes_); }

 private:
  void add_bytes(std::span<const std::byte> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }

  PieceBytes bytes_;
};

/// Reads what a PieceWriter wrote. The bytes may come from another host: beyond their end everything reads as 0, and
/// finished() then reports an error.
class PieceReader {
 public:
  explicit PieceReader(std::span<const std::byte> bytes) : left_(bytes) {}

  template <typename Value>
  requires(std::is_arithmetic_v<Value>) [[nodiscard]] Value read() {
    Value value{};
    read_into(&value, sizeof(value));
    return value;
  }
  [[nodiscard]] render::Vec3 read_vector() {
    render::Vec3 value = render::Vec3::Zero();
    read_into(value.data(), 3 * sizeof(float));
    return value;
  }
  /// Returns a number of elements, 0 unless the bytes could hold so many of `bytes_each`.
  [[nodiscard]] std::size_t read_count(std::size_t bytes_each) {
    const auto count = read<std::uint32_t>();
    if (count <= left_.size() / bytes_each) return count;
    is_short_ = true;
    return 0;
  }
  /// Errors: kBadData unless exactly all bytes were read.
  [[nodiscard]] Status finished() const {
    if (!is_short_ && left_.empty()) return Done{};
    return Error(ErrorCode::kBadData, "a piece of light has another length than its results");
  }

 private:
  void read_into(void* value, std::size_t bytes) {
    is_short_ |= bytes > left_.size();
    if (is_short_) return;
    std::memcpy(value, left_.data(), bytes);
    left_ = left_.subspan(bytes);
  }

  std::span<const std::byte> left_;
  bool is_short_ = false;
};

}  // namespace cyclorama::light_baking

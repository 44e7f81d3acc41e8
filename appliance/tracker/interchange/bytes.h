// SPDX-License-Identifier: Apache-2.0
/// Big-endian numbers in packets, for OSC and VRPN.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace cyclorama::tracker {

/// Reads numbers from the front of a packet. After a read beyond the packet's end, is_short() is true and all numbers
/// are zero. Borrows the packet.
class PacketReader {
 public:
  explicit PacketReader(std::span<const std::byte> bytes) : left_(bytes) {}
  [[nodiscard]] bool is_empty() const { return left_.empty(); }
  [[nodiscard]] bool is_short() const { return short_; }
  [[nodiscard]] std::size_t left() const { return left_.size(); }
  std::span<const std::byte> bytes(std::size_t count) {
    if (count > left_.size()) short_ = true;
    const auto taken = left_.first(short_ ? 0 : count);
    left_ = short_ ? left_.first(0) : left_.subspan(count);
    return taken;
  }
  std::uint32_t u32() { return static_cast<std::uint32_t>(whole(4)); }
  std::uint64_t u64() { return whole(8); }
  std::int32_t i32() { return std::bit_cast<std::int32_t>(u32()); }
  std::int64_t i64() { return std::bit_cast<std::int64_t>(u64()); }
  float f32() { return std::bit_cast<float>(u32()); }
  double f64() { return std::bit_cast<double>(u64()); }

 private:
  std::uint64_t whole(std::size_t count) {
    std::uint64_t value = 0;
    for (const std::byte b : bytes(count)) value = value << 8 | std::to_integer<std::uint64_t>(b);
    return value;
  }
  std::span<const std::byte> left_;
  bool short_ = false;
};

/// Appends numbers and texts to a packet.
class PacketWriter {
 public:
  void u32(std::uint32_t value) { whole(value, 4); }
  void u64(std::uint64_t value) { whole(value, 8); }
  void i32(std::int32_t value) { u32(std::bit_cast<std::uint32_t>(value)); }
  void i64(std::int64_t value) { u64(std::bit_cast<std::uint64_t>(value)); }
  void f32(float value) { u32(std::bit_cast<std::uint32_t>(value)); }
  void f64(double value) { u64(std::bit_cast<std::uint64_t>(value)); }
  void text(std::string_view value) {
    std::transform(value.begin(), value.end(), std::back_inserter(bytes_),
                   [](char c) { return static_cast<std::byte>(c); });
  }
  void raw(std::span<const std::byte> value) { bytes_.insert(bytes_.end(), value.begin(), value.end()); }
  /// Appends zeros up to a multiple of `unit`.
  void pad(std::size_t unit) { bytes_.resize((bytes_.size() + unit - 1) / unit * unit); }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  [[nodiscard]] std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  void whole(std::uint64_t value, int count) {
    for (int i = count - 1; i >= 0; --i) bytes_.push_back(static_cast<std::byte>(value >> (8 * i) & 0xff));
  }
  std::vector<std::byte> bytes_;
};

}  // namespace cyclorama::tracker

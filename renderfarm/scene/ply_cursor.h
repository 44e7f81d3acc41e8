// SPDX-License-Identifier: Apache-2.0
/// Cursors that read the values of a PLY body in file order. Both have the same interface, so one template, compiled
/// for each encoding, reads rows without a virtual call per value. Cursors are thread-bound and borrow the file's
/// bytes.
#pragma once

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "common/base/text_lines.h"
#include "renderfarm/scene/ply_header.h"

namespace cyclorama::scene {

template <bool kSwapped>
class PlyBinaryCursor {
 public:
  PlyBinaryCursor(std::span<const std::byte> file, const PlyHeader& header)
      : at_(file.data() + header.body_offset), end_(file.data() + file.size()) {}

  /// Reads one value; returns false at the end of the file.
  bool read(PlyType type, double* ret_value) {
    switch (type) {
      case PlyType::kInt8:
        return take<std::int8_t>(ret_value);
      case PlyType::kUint8:
        return take<std::uint8_t>(ret_value);
      case PlyType::kInt16:
        return take<std::int16_t>(ret_value);
      case PlyType::kUint16:
        return take<std::uint16_t>(ret_value);
      case PlyType::kInt32:
        return take<std::int32_t>(ret_value);
      case PlyType::kUint32:
        return take<std::uint32_t>(ret_value);
      case PlyType::kFloat32:
        return take<float>(ret_value);
      case PlyType::kFloat64:
        return take<double>(ret_value);
    }
    return false;
  }
  /// begin_row() and end_row() are called before and after each row; they return false if the row is incomplete.
  bool begin_row() { return true; }
  bool end_row() { return true; }
  /// Returns the reason why read(), begin_row() or end_row() returned false.
  [[nodiscard]] std::string what() const { return "the file ends there: it is cut short; copy it again"; }
  [[nodiscard]] std::size_t bytes_left() const { return static_cast<std::size_t>(end_ - at_); }

 private:
  template <typename T>
  bool take(double* ret_value) {
    if (bytes_left() < sizeof(T)) return false;
    std::array<std::byte, sizeof(T)> bytes;
    std::memcpy(bytes.data(), at_, sizeof(T));
    if constexpr (kSwapped) {
      for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(bytes[i], bytes[sizeof(T) - 1 - i]);
    }
    *ret_value = static_cast<double>(std::bit_cast<T>(bytes));
    at_ += sizeof(T);
    return true;
  }
  const std::byte* at_;
  const std::byte* end_;
};

/// Reads one row per line; skips empty lines.
class PlyTextCursor {
 public:
  PlyTextCursor(std::span<const std::byte> file, const PlyHeader& header)
      : lines_(std::string_view(reinterpret_cast<const char*>(file.data()), file.size()).substr(header.body_offset)),
        bytes_(file.size() - header.body_offset),
        line_(header.body_line - 1) {}

  bool read(PlyType, double* ret_value) {
    const std::string_view word = next_word(&rest_);
    if (word.empty()) return fail("has fewer values than the header announces");
    bool whole = false;
    const std::optional<double> value = number_in(word, &whole);
    if (!value || !whole) return fail("has a value that is not a number");
    *ret_value = *value;
    return true;
  }
  bool begin_row() {
    do {
      if (!lines_.next(&rest_)) return fail("is missing: the file is cut short; copy it again");
      ++line_;
      rest_ = trimmed(rest_);
    } while (rest_.empty());
    return true;
  }
  bool end_row() { return next_word(&rest_).empty() || fail("has more values than the header announces"); }
  [[nodiscard]] std::string what() const { return fmt::format("line {} {}", line_, what_); }
  [[nodiscard]] std::size_t bytes_left() const { return bytes_ - lines_.offset() + rest_.size(); }

 private:
  bool fail(const char* what) {
    what_ = what;
    return false;
  }
  LineReader lines_;
  std::string_view rest_;
  std::size_t bytes_;
  std::size_t line_;
  const char* what_ = "";
};

}  // namespace cyclorama::scene

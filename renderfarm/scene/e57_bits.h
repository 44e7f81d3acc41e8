// SPDX-License-Identifier: Apache-2.0
/// One field of E57's points: its numbers lie in a stream of their own, packed to as many bits as their range needs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/e57_xml.h"

namespace cyclorama::scene {

/// Thread-bound.
class E57Field {
 public:
  /// Reads a child of a prototype. Errors: kBadData if it is none.
  static Result<E57Field> of(const E57Node& node);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] int bits() const { return bits_; }  ///< Bits of each number; 0 for one that is always the same.
  [[nodiscard]] double minimum() const { return minimum_; }
  [[nodiscard]] double maximum() const { return maximum_; }  ///< Not above minimum() if the file states no range.

  void append(std::span<const std::byte> bytes) { pending_.insert(pending_.end(), bytes.begin(), bytes.end()); }
  /// Number of complete values; the largest number if bits() is 0.
  [[nodiscard]] std::uint64_t available() const;
  /// Precondition: available() is not 0.
  double next();
  /// Frees the memory of values that were taken.
  void forget_taken();

 private:
  enum class Kind : std::uint8_t { kInteger, kFloat32, kFloat64 };

  std::string name_;
  Kind kind_ = Kind::kInteger;
  int bits_ = 0;
  std::int64_t raw_minimum_ = 0;
  double scale_ = 1.0;
  double offset_ = 0.0;
  double minimum_ = 0.0;
  double maximum_ = 0.0;
  std::vector<std::byte> pending_;
  std::uint64_t taken_bits_ = 0;
};

}  // namespace cyclorama::scene

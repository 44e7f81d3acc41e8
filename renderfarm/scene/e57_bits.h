// SPDX-License-Identifier: Apache-2.0
/// One field of the points in an E57 file. The numbers of each field are in a separate stream, each packed to as many
/// bits as the field's range needs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/e57_xml.h"

namespace cyclorama::scene {

/// Decoder of the numbers of one field. Thread-bound.
class E57Field {
 public:
  /// Creates the field that `node`, a child of a prototype, describes. Errors: kBadData if it describes no field.
  static Result<E57Field> of(const E57Node& node);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] int bits() const { return bits_; }  ///< Bits of each number; 0 if all numbers are the same.
  [[nodiscard]] double minimum() const { return minimum_; }
  [[nodiscard]] double maximum() const { return maximum_; }  ///< Not above minimum() if the file states no range.

  void append(std::span<const std::byte> bytes) { pending_.insert(pending_.end(), bytes.begin(), bytes.end()); }
  /// Returns the number of complete values; the maximum of the type if bits() is 0.
  [[nodiscard]] std::uint64_t available() const;
  /// Returns the next value. Precondition: available() is not 0.
  double next();
  /// Frees the memory of the values that next() has returned.
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

// SPDX-License-Identifier: Apache-2.0
/// Bits and Huffman codes of Basis Universal, as KTX 2.0 stores them. Source: KTX 2.0, "BasisLZ Bitstream Specification".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/base/result.h"

namespace cyclorama {

/// Reads bits, the lowest of each byte first. Beyond the end it gives zeros and remembers that. Borrows the bytes.
/// Thread-bound.
class BasisBits {
 public:
  explicit BasisBits(std::span<const std::byte> bytes) : bytes_(bytes) {}

  /// Precondition: `count` is at most 25.
  std::uint32_t take(int count);
  /// Takes an integer that is stored in groups of `group_bits`, each with a bit that is set if another follows.
  std::uint32_t take_groups(int group_bits);
  /// True once more bits were taken than there are, or an integer did not end.
  [[nodiscard]] bool overran() const { return overran_; }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_bit_ = 0;
  bool overran_ = false;
};

/// A canonical Huffman code with words of at most 16 bits.
class BasisHuffman {
 public:
  static constexpr std::uint32_t kNone = 0xffff'ffff;

  /// Reads a code as BasisLZ stores it. Errors: kBadData if it is damaged. A code without words is good, and decodes
  /// nothing.
  static Result<BasisHuffman> read(BasisBits* bits);
  /// Returns the next symbol; kNone if the bits are none of the code's words.
  std::uint32_t next(BasisBits* bits) const;

 private:
  static constexpr int kMaxBits = 16;
  static Result<BasisHuffman> of_lengths(const std::vector<std::uint8_t>& lengths);

  std::array<std::uint32_t, kMaxBits + 1> count_{};  ///< Number of words of each length.
  std::vector<std::uint16_t> symbols_;               ///< In the order of their words.
};

}  // namespace cyclorama

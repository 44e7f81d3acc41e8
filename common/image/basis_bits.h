// SPDX-License-Identifier: Apache-2.0
/// Bits and Huffman codes of Basis Universal, as stored in KTX 2.0. Source: KTX 2.0, "BasisLZ Bitstream Specification".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/base/result.h"

namespace cyclorama {

/// Reads bits, from the lowest of each byte. Beyond the end, bits are zero and overran() is true. Borrows the bytes.
/// Thread-bound.
class BasisBits {
 public:
  explicit BasisBits(std::span<const std::byte> bytes) : bytes_(bytes) {}

  /// Takes the next `count` bits. Precondition: `count` is at most 25.
  std::uint32_t take(int count);
  /// Takes an integer that is stored in groups of `group_bits`, each followed by a bit that is set if another group
  /// follows.
  std::uint32_t take_groups(int group_bits);
  /// True once more bits were taken than exist, or if an integer did not end.
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

  /// Reads a code as stored by BasisLZ. Errors: kBadData if it is damaged. A code without words is valid, and decodes
  /// nothing.
  static Result<BasisHuffman> read(BasisBits* bits);
  /// Returns the next symbol; kNone if the bits are not a word of the code.
  std::uint32_t next(BasisBits* bits) const;

 private:
  static constexpr int kMaxBits = 16;
  static Result<BasisHuffman> of_lengths(const std::vector<std::uint8_t>& lengths);

  std::array<std::uint32_t, kMaxBits + 1> count_{};  ///< Number of words of each length.
  std::vector<std::uint16_t> symbols_;               ///< In the order of their code words.
};

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
#include "common/image/basis_bits.h"

#include <algorithm>

namespace cyclorama {
namespace {

constexpr std::uint32_t kMaxLength = 16;
/// Symbols of the code that stores lengths: 0 to 16 are lengths; the others repeat a length or zero.
enum LengthSymbol : std::uint32_t { kShortZeros = 17, kLongZeros, kShortRepeat, kLongRepeat, kLengthSymbols };
constexpr std::array<std::uint8_t, kLengthSymbols> kLengthOrder = {17, 18, 19, 20, 0,  8, 7,  9, 6,  10, 5,
                                                                   11, 4,  12, 3,  13, 2, 14, 1, 15, 16};

Error damaged() { return Error(ErrorCode::kBadData, "a Huffman code of the KTX2 texture is damaged"); }

}  // namespace

std::uint32_t BasisBits::take(int count) {
  std::uint32_t value = 0;
  const std::size_t first = at_bit_ / 8;
  for (std::size_t i = 0; i < 4 && first + i < bytes_.size(); ++i) {
    value |= static_cast<std::uint32_t>(bytes_[first + i]) << (8 * i);
  }
  value >>= at_bit_ % 8;
  at_bit_ += static_cast<std::size_t>(count);
  overran_ = overran_ || at_bit_ > 8 * bytes_.size();
  return value & ((1u << count) - 1u);
}

std::uint32_t BasisBits::take_groups(int group_bits) {
  std::uint32_t value = 0;
  for (int at = 0; at < 32; at += group_bits) {
    const std::uint32_t group = take(group_bits + 1);
    value |= (group & ((1u << group_bits) - 1u)) << at;
    if (group >> group_bits == 0) return value;
  }
  overran_ = true;
  return 0;
}

Result<BasisHuffman> BasisHuffman::of_lengths(const std::vector<std::uint8_t>& lengths) {
  BasisHuffman code;
  for (const std::uint8_t length : lengths) ++code.count_[length];
  code.count_[0] = 0;
  std::uint32_t free = 1;
  std::array<std::uint32_t, kMaxBits + 2> first{};
  for (std::size_t length = 1; length <= kMaxLength; ++length) {
    free *= 2;
    if (code.count_[length] > free) return damaged();  // There are more words than this length allows.
    free -= code.count_[length];
    first[length + 1] = first[length] + code.count_[length];
  }
  code.symbols_.resize(first[kMaxLength + 1]);
  for (std::size_t symbol = 0; symbol < lengths.size(); ++symbol) {
    if (lengths[symbol] != 0) code.symbols_[first[lengths[symbol]]++] = static_cast<std::uint16_t>(symbol);
  }
  return code;
}

Result<BasisHuffman> BasisHuffman::read(BasisBits* bits) {
  const std::uint32_t symbols = bits->take(14);
  if (symbols == 0) return BasisHuffman();
  const std::uint32_t stored = bits->take(5);
  if (stored < 1 || stored > kLengthSymbols) return damaged();
  std::vector<std::uint8_t> lengths(kLengthSymbols);
  for (std::size_t i = 0; i < stored; ++i) lengths[kLengthOrder[i]] = static_cast<std::uint8_t>(bits->take(3));
  TRY_ASSIGN(const BasisHuffman length_code, of_lengths(lengths));
  lengths.clear();
  while (lengths.size() < symbols) {
    const std::uint32_t symbol = length_code.next(bits);
    std::uint32_t times = 1;
    std::uint32_t length = 0;
    if (symbol <= kMaxLength) {
      length = symbol;
    } else if (symbol == kShortZeros) {
      times = bits->take(3) + 3;
    } else if (symbol == kLongZeros) {
      times = bits->take(7) + 11;
    } else if (symbol < kLengthSymbols && !lengths.empty() && lengths.back() != 0) {
      times = symbol == kShortRepeat ? bits->take(2) + 3 : bits->take(7) + 7;
      length = lengths.back();
    } else {
      return damaged();
    }
    if (bits->overran() || times > symbols - lengths.size()) return damaged();
    lengths.insert(lengths.end(), times, static_cast<std::uint8_t>(length));
  }
  return of_lengths(lengths);
}

std::uint32_t BasisHuffman::next(BasisBits* bits) const {
  std::uint32_t word = 0;
  std::uint32_t first = 0;  // First word of this length, and its position among the symbols.
  std::size_t place = 0;
  for (std::size_t length = 1; length <= kMaxLength; ++length) {
    word = word << 1 | bits->take(1);
    if (word - first < count_[length]) return symbols_[place + word - first];
    place += count_[length];
    first = (first + count_[length]) << 1;
  }
  return kNone;
}

}  // namespace cyclorama

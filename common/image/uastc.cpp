// SPDX-License-Identifier: Apache-2.0
#include "common/image/uastc.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "common/image/basis_bits.h"

namespace cyclorama {
namespace {

/// A code of endpoints: plain bits, and a digit of base `radix` (0: none). Several endpoints' digits share a number. A
/// value is ((digit * scale + spread) ^ mirror) >> 2, as in ASTC; the text `spread` gives, for each of nine bits from
/// the highest, the plain bit that is put there ('a' is the lowest, '0' none).
struct EndpointCode {
  int bits;
  std::uint32_t radix;
  const char* spread;
  std::uint32_t scale;
};
constexpr EndpointCode kLevels12 = {2, 3, "b000b0bb0", 93};
constexpr EndpointCode kLevels16 = {4, 0, "", 0};
constexpr EndpointCode kLevels32 = {5, 0, "", 0};
constexpr EndpointCode kLevels40 = {3, 5, "cb0000cbc", 26};
constexpr EndpointCode kLevels48 = {4, 3, "dcb000dcb", 22};
constexpr EndpointCode kLevels160 = {5, 5, "edcb0000e", 6};
constexpr EndpointCode kLevels192 = {6, 3, "fedcb000f", 5};
constexpr EndpointCode kLevels256 = {8, 0, "", 0};

struct Mode {
  std::uint32_t word;  ///< The block's first bits.
  int word_bits;
  int hint_bits;  ///< For programs that recompress the block; skipped.
  int weight_bits;
  const EndpointCode* endpoints;
  std::size_t subsets;
  std::size_t planes;
  std::size_t channels;  ///< 3 for RGB, 4 for RGBA, 2 for grey and alpha.
};
constexpr std::size_t kSolidMode = 8;
constexpr std::size_t kTwoSubsetsOfThreeMode = 7;
constexpr std::array<Mode, 19> kModes = {{
    {0x01, 4, 15, 4, &kLevels192, 1, 1, 3}, {0x35, 6, 15, 2, &kLevels256, 1, 1, 3},
    {0x1d, 5, 15, 3, &kLevels16, 2, 1, 3},  {0x03, 5, 15, 2, &kLevels12, 3, 1, 3},
    {0x13, 5, 15, 2, &kLevels40, 2, 1, 3},  {0x0b, 5, 15, 3, &kLevels256, 1, 1, 3},
    {0x1b, 5, 15, 2, &kLevels160, 1, 2, 3}, {0x07, 5, 15, 2, &kLevels40, 2, 1, 3},
    {0x17, 5, 0, 0, &kLevels256, 1, 1, 4},  {0x0f, 5, 23, 2, &kLevels16, 2, 1, 4},
    {0x02, 3, 17, 4, &kLevels48, 1, 1, 4},  {0x00, 2, 17, 2, &kLevels48, 1, 2, 4},
    {0x06, 3, 17, 3, &kLevels192, 1, 1, 4}, {0x1f, 5, 23, 1, &kLevels256, 1, 2, 4},
    {0x0d, 5, 23, 2, &kLevels256, 1, 1, 4}, {0x05, 7, 23, 4, &kLevels256, 1, 1, 2},
    {0x15, 6, 23, 2, &kLevels256, 2, 1, 2}, {0x25, 6, 23, 2, &kLevels256, 1, 2, 2},
    {0x09, 4, 15, 5, &kLevels32, 1, 1, 3},
}};

// Partitions: the subset of each pixel; that of the first pixel is in the lowest bits.
constexpr std::array<std::uint16_t, 30> kTwoSubsets = {0xcccc, 0x8888, 0x1111, 0xecc8, 0x377f, 0xfeec, 0x0137, 0x137f,
                                                       0xc800, 0x0013, 0xfe80, 0x17ff, 0x0017, 0x00ff, 0xfff0, 0x0fff,
                                                       0xff71, 0x8eff, 0x08ce, 0x008c, 0x7310, 0xceff, 0x7331, 0x088c,
                                                       0xceef, 0x6666, 0xf00f, 0x5555, 0x0f0f, 0x36c9};
constexpr std::array<std::uint16_t, 19> kTwoSubsetsOfThree = {0x00f0, 0x4444, 0x0133, 0xcc80, 0xf0ff, 0x2222, 0xffc8,
                                                              0xccce, 0x3c03, 0x00ee, 0x7700, 0x3003, 0x00ce, 0xff80,
                                                              0x6fff, 0x1333, 0x11ff, 0x136c, 0x00ef};
constexpr std::array<std::uint32_t, 11> kThreeSubsets = {0xa5a50000, 0xaa005555, 0xaa000055, 0x0000aa55,
                                                         0x25252525, 0x94949494, 0x58585858, 0x56560202,
                                                         0x92929292, 0x55aa0055, 0xa05050a0};

using Subsets = std::array<std::size_t, 16>;
constexpr std::size_t kMaxEndpoints = 18;
using Endpoints = std::array<std::uint32_t, kMaxEndpoints>;

std::uint32_t endpoint_value(const EndpointCode& code, std::uint32_t plain, std::uint32_t digit) {
  if (code.radix == 0) return code.bits == 8 ? plain : code.bits == 5 ? plain << 3 | plain >> 2 : plain * 17;
  const std::uint32_t mirror = (plain & 1u) != 0 ? 511u : 0u;
  std::uint32_t spread = 0;
  for (const char* at = code.spread; *at != '\0'; ++at) {
    spread = spread << 1 | (*at == '0' ? 0u : plain >> (*at - 'a') & 1u);
  }
  return (mirror & 0x80u) | ((digit * code.scale + spread) ^ mirror) >> 2;
}

/// Reads endpoints. The digits come first, as numbers of five digits (base 3) or three (base 5), then all plain bits.
Endpoints read_endpoints(const EndpointCode& code, std::size_t count, BasisBits* bits) {
  constexpr std::array<int, 6> kBitsOfTrits = {0, 2, 4, 5, 7, 8};
  constexpr std::array<int, 4> kBitsOfQuints = {0, 3, 5, 7};
  Endpoints digits{};
  const std::size_t together = code.radix == 3 ? 5 : 3;
  for (std::size_t first = 0; code.radix != 0 && first < count; first += together) {
    const std::size_t some = std::min(together, count - first);
    std::uint32_t number = bits->take(code.radix == 3 ? kBitsOfTrits[some] : kBitsOfQuints[some]);
    for (std::size_t i = 0; i < some; ++i, number /= code.radix) digits[first + i] = number % code.radix;
  }
  Endpoints values{};
  for (std::size_t i = 0; i < count; ++i) values[i] = endpoint_value(code, bits->take(code.bits), digits[i]);
  return values;
}

/// Reads the subset of each pixel; empty if there is no such partition.
std::optional<Subsets> read_subsets(std::size_t mode, BasisBits* bits) {
  Subsets subsets{};
  const std::size_t count = kModes[mode].subsets;
  if (count == 1) return subsets;
  const std::size_t index = bits->take(count == 2 ? 5 : 4);
  for (std::size_t i = 0; i < subsets.size(); ++i) {
    if (count == 3) {
      if (index >= kThreeSubsets.size()) return std::nullopt;
      subsets[i] = kThreeSubsets[index] >> 2 * i & 3u;
    } else if (mode == kTwoSubsetsOfThreeMode) {
      if (index >= kTwoSubsetsOfThree.size()) return std::nullopt;
      subsets[i] = static_cast<std::uint32_t>(kTwoSubsetsOfThree[index]) >> i & 1u;
    } else {
      if (index >= kTwoSubsets.size()) return std::nullopt;
      subsets[i] = static_cast<std::uint32_t>(kTwoSubsets[index]) >> i & 1u;
    }
  }
  return subsets;
}

/// Returns a stored weight in 64ths.
std::uint32_t weight_of(std::uint32_t stored, int bits) {
  constexpr std::array<std::uint32_t, 4> kTwo = {0, 21, 43, 64};
  constexpr std::array<std::uint32_t, 8> kThree = {0, 9, 18, 27, 37, 46, 55, 64};
  constexpr std::array<std::uint32_t, 16> kFour = {0, 4, 8, 12, 17, 21, 25, 29, 35, 39, 43, 47, 52, 56, 60, 64};
  switch (bits) {
    case 1:
      return stored * 64;
    case 2:
      return kTwo[stored];
    case 3:
      return kThree[stored];
    case 4:
      return kFour[stored];
    default:
      return 2 * stored + (stored >= 16 ? 2 : 0);
  }
}

std::uint8_t blend(std::uint32_t low, std::uint32_t high, std::uint32_t weight) {
  return static_cast<std::uint8_t>((low * 257 * (64 - weight) + high * 257 * weight + 32) >> 14);
}

using Weights = std::array<std::uint32_t, 32>;

/// Reads weights. The highest bit of the first weight of each subset, and of each plane, is zero and not stored.
Weights read_weights(const Mode& mode, const Subsets& subsets, BasisBits* bits) {
  Weights weights{};
  std::array<bool, 3> seen{};
  for (std::size_t i = 0; i < 16 * mode.planes; ++i) {
    bool is_first = i < mode.planes;
    if (mode.planes == 1) is_first = !std::exchange(seen[subsets[i]], true);
    weights[i] = weight_of(bits->take(is_first ? mode.weight_bits - 1 : mode.weight_bits), mode.weight_bits);
  }
  return weights;
}

}  // namespace

std::optional<UastcPixels> decode_uastc(std::span<const std::byte> block) {
  BasisBits bits(block);
  std::size_t mode_index = 0;
  const std::uint32_t head = BasisBits(block).take(7);
  const auto is_mode = [&](const Mode& mode) { return (head & ((1u << mode.word_bits) - 1u)) == mode.word; };
  while (mode_index < kModes.size() && !is_mode(kModes[mode_index])) ++mode_index;
  if (mode_index == kModes.size()) return std::nullopt;
  const Mode& mode = kModes[mode_index];
  bits.take(mode.word_bits);
  UastcPixels pixels;
  if (mode_index == kSolidMode) {
    for (std::uint8_t& channel : pixels[0]) channel = static_cast<std::uint8_t>(bits.take(8));
    pixels.fill(pixels[0]);
    return pixels;
  }
  bits.take(mode.hint_bits);
  const std::optional<Subsets> subsets = read_subsets(mode_index, &bits);
  if (!subsets) return std::nullopt;
  std::size_t second_plane = 4;  // Channel with weights of its own.
  if (mode.planes == 2) second_plane = mode.channels == 2 ? 3 : bits.take(2);
  const Endpoints ends = read_endpoints(*mode.endpoints, 2 * mode.channels * mode.subsets, &bits);
  const Weights weights = read_weights(mode, *subsets, &bits);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const std::size_t first_end = 2 * mode.channels * (*subsets)[i];
    for (std::size_t c = 0; c < 4; ++c) {
      const std::uint32_t weight = weights[i * mode.planes + (c == second_plane ? 1 : 0)];
      const std::size_t pair = mode.channels == 2 ? (c == 3 ? 1 : 0) : c;
      const std::size_t at = first_end + 2 * pair;
      pixels[i][c] = pair < mode.channels ? blend(ends[at], ends[at + 1], weight) : std::uint8_t{255};
    }
  }
  return pixels;
}

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/gltf_meshopt_attributes.h"

#include <gtest/gtest.h>

#include <cstring>
#include <initializer_list>

namespace cyclorama::scene {
namespace {

using Bytes = std::vector<std::byte>;

Bytes bytes_of(std::initializer_list<int> values) {
  Bytes bytes;
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

void append(const Bytes& from, Bytes* to) { to->insert(to->end(), from.begin(), from.end()); }

/// Returns a stream of elements of four bytes: the data blocks between their header and their tail, in which
/// `baseline` is the element before the first one.
Bytes stream_of(const Bytes& block, const Bytes& baseline, int channel_mode) {
  Bytes stream = bytes_of({0xa1});
  append(block, &stream);
  append(Bytes(24 - 5), &stream);
  append(baseline, &stream);
  append(bytes_of({channel_mode}), &stream);
  return stream;
}

TEST(MeshoptAttributes, the_example_of_the_specification_is_decoded) {
  // The first byte of sixteen elements has deltas of four bits and two whole ones; the other bytes do not change.
  Bytes block = bytes_of({0 | 2 << 2 | 2 << 4 | 2 << 6, 3});
  append(bytes_of({0x17, 0x5f, 0xf0, 0xbc, 0x77, 0xa9, 0x21, 0x00, 0x34, 0xb5}), &block);
  const auto decoded = decode_meshopt_attributes_v1(stream_of(block, bytes_of({100, 7, 8, 9}), 0), 16, 4);
  ASSERT_TRUE(decoded.has_value());
  const std::vector<int> deltas = {-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0};
  int value = 100;
  for (std::size_t i = 0; i < 16; ++i) {
    value += deltas[i];
    EXPECT_EQ(std::to_integer<int>((*decoded)[4 * i]), value & 255) << i;
    EXPECT_EQ(std::to_integer<int>((*decoded)[4 * i + 3]), 9);
  }
}

TEST(MeshoptAttributes, single_bits_begin_at_the_lowest) {
  // Control mode 1 with single bits: elements 0 and 9 have whole deltas, 4 and 2 before their zigzag.
  Bytes block = bytes_of({1 | 2 << 2 | 2 << 4 | 2 << 6, 0, 1, 2, 8, 4});
  const auto decoded = decode_meshopt_attributes_v1(stream_of(block, bytes_of({0, 0, 0, 0}), 0), 16, 4);
  ASSERT_TRUE(decoded.has_value());
  EXPECT_EQ(std::to_integer<int>((*decoded)[0]), 4);
  EXPECT_EQ(std::to_integer<int>((*decoded)[32]), 4);
  EXPECT_EQ(std::to_integer<int>((*decoded)[36]), 6);
  EXPECT_EQ(std::to_integer<int>((*decoded)[60]), 6);
}

TEST(MeshoptAttributes, two_bytes_are_added_and_four_are_rotated) {
  // Literal deltas of one element: all four bytes have control mode 3.
  const auto one = [](const Bytes& delta, const Bytes& baseline, int mode) {
    Bytes block = bytes_of({0xff});
    append(delta, &block);
    return decode_meshopt_attributes_v1(stream_of(block, baseline, mode), 1, 4);
  };
  // 0x00ff + 1 and 0x0100 - 1: zigzag codes 2 and 1.
  EXPECT_EQ(one(bytes_of({2, 0, 1, 0}), bytes_of({0xff, 0, 0, 1}), 1), bytes_of({0, 1, 0xff, 0}));
  // The bits 0x10203040 were rotated to the left by 8, and are flipped in 0xffffffff.
  EXPECT_EQ(one(bytes_of({0x10, 0x40, 0x30, 0x20}), bytes_of({255, 255, 255, 255}), 2 | 8 << 4),
            bytes_of({0xbf, 0xcf, 0xdf, 0xef}));
  EXPECT_EQ(one(bytes_of({0, 0, 0, 0}), bytes_of({0, 0, 0, 0}), 3), std::nullopt);
  EXPECT_EQ(one(bytes_of({0, 0, 0, 0}), bytes_of({0, 0, 0, 0}), 1 | 1 << 4), std::nullopt);
}

TEST(MeshoptAttributes, elements_go_on_from_block_to_block) {
  // Blocks of 256 elements of 4 bytes: every element of the first byte grows by one.
  constexpr std::size_t kCount = 600;
  Bytes blocks;
  for (std::size_t first = 0; first < kCount; first += 256) {
    append(bytes_of({3 | 2 << 2 | 2 << 4 | 2 << 6}), &blocks);
    append(Bytes(std::min<std::size_t>(256, kCount - first), std::byte{2}), &blocks);
  }
  const auto decoded = decode_meshopt_attributes_v1(stream_of(blocks, bytes_of({0, 0, 0, 0}), 0), kCount, 4);
  ASSERT_TRUE(decoded.has_value());
  for (std::size_t i = 0; i < kCount; ++i) {
    ASSERT_EQ(std::to_integer<std::size_t>((*decoded)[4 * i]), (i + 1) % 256);
  }
}

TEST(MeshoptAttributes, shortened_and_lengthened_streams_are_refused) {
  Bytes block = bytes_of({0xff});
  append(Bytes(64, std::byte{1}), &block);
  const Bytes whole = stream_of(block, bytes_of({1, 2, 3, 4}), 0);
  ASSERT_TRUE(decode_meshopt_attributes_v1(whole, 16, 4).has_value());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(decode_meshopt_attributes_v1(std::span(whole).first(size), 16, 4).has_value()) << size;
  }
  Bytes longer = whole;
  longer.insert(longer.begin() + 2, std::byte{0});
  EXPECT_FALSE(decode_meshopt_attributes_v1(longer, 16, 4).has_value());
}

TEST(MeshoptColourFilter, returns_the_colours_that_were_encoded) {
  // Eight bits: luma 100, orange 50, green -20 and the whole alpha 127 with its mark in front.
  Bytes colour = bytes_of({100, 50, -20 & 255, 0xff});
  apply_meshopt_colour_filter(4, colour);
  EXPECT_EQ(colour, bytes_of({170, 80, 70, 255}));
  // The same with 16 bits for each component but 8 bits of precision: 255 becomes 65535.
  const std::array<std::uint16_t, 4> words = {100, 50, static_cast<std::uint16_t>(-20), 0xff};
  Bytes wide(8);
  std::memcpy(wide.data(), words.data(), 8);
  apply_meshopt_colour_filter(8, wide);
  std::array<std::uint16_t, 4> rgba{};
  std::memcpy(rgba.data(), wide.data(), 8);
  EXPECT_EQ(rgba, (std::array<std::uint16_t, 4>{170 * 257, 80 * 257, 70 * 257, 65535}));
  // An alpha without a mark states no precision; such a colour is damaged but has a value.
  Bytes damaged = bytes_of({1, 2, 3, 0});
  apply_meshopt_colour_filter(4, damaged);
  EXPECT_EQ(damaged, bytes_of({0, 0, 0, 0}));
}

}  // namespace
}  // namespace cyclorama::scene

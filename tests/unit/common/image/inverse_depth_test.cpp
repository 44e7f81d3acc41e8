// SPDX-License-Identifier: Apache-2.0
#include "common/image/inverse_depth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace cyclorama {
namespace {

constexpr std::uint16_t kUntouched = 777;

std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

PixelRect all_of(const InverseDepthImage& depth) { return {0, 0, depth.width(), depth.height()}; }

template <typename Value>
InverseDepthImage made(int width, int height, const Value& value) {
  InverseDepthImage depth(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) *depth.at(x, y) = static_cast<std::uint16_t>(value(x, y));
  }
  return depth;
}

InverseDepthImage random_depth(int width, int height) {
  std::mt19937 random(static_cast<unsigned>(97 * width + height));
  std::uniform_int_distribution<int> values(0, kMaxInverseDepth);
  return made(width, height, [&](int, int) { return values(random); });
}

/// A floor, a wall and a post in front of it.
InverseDepthImage room_depth(int width, int height) {
  return made(width, height, [&](int x, int y) {
    if (x > width / 3 && x < width / 2) return 900;
    return std::max(137 + x / 9, 40 * y / height * 20);
  });
}

TEST(InverseDepth, is_proportional_to_the_inverse_distance_within_its_range) {
  EXPECT_EQ(inverse_depth_of(1.0f), 410);
  EXPECT_EQ(inverse_depth_of(2.0f), 205);
  EXPECT_EQ(inverse_depth_of(0.1f), kMaxInverseDepth);
  EXPECT_EQ(inverse_depth_of(1e-3f), kMaxInverseDepth);
  EXPECT_EQ(inverse_depth_of(0.0f), kMaxInverseDepth);
  EXPECT_EQ(inverse_depth_of(100.0f), 4);
  EXPECT_EQ(inverse_depth_of(1e5f), 0);
  EXPECT_EQ(inverse_depth_of(std::numeric_limits<float>::infinity()), 0);
  EXPECT_EQ(inverse_depth_of(std::numeric_limits<float>::quiet_NaN()), 0);
  for (const float distance_m : {0.15f, 0.8f, 3.7f, 25.0f}) {
    EXPECT_NEAR(inverse_metres(inverse_depth_of(distance_m)), 1.0f / distance_m, 0.51f / 409.5f) << distance_m;
  }
}

TEST(InverseDepth, has_the_cells_that_a_rectangle_touches) {
  EXPECT_EQ(depth_cells({0, 0, 256, 128}), (PixelRect{0, 0, 64, 32}));
  EXPECT_EQ(depth_cells({16, 32, 17, 1}), (PixelRect{4, 8, 5, 1}));
  EXPECT_EQ(depth_cells({3, 7, 2, 2}), (PixelRect{0, 1, 2, 2}));
  EXPECT_TRUE(depth_cells({3, 7, 0, 2}).empty());
}

TEST(InverseDepth, survives_a_round_trip_of_any_content_and_size) {
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{1, 9}, std::pair{9, 1}, std::pair{2, 2},
                                      std::pair{63, 31}, std::pair{64, 64}, std::pair{517, 193}}) {
    const auto maximum = [](int, int) { return kMaxInverseDepth; };
    const auto chequered = [](int x, int y) { return (x + y) % 2 == 0 ? 0 : kMaxInverseDepth; };
    for (const InverseDepthImage& depth :
         {random_depth(width, height), room_depth(width, height), InverseDepthImage(width, height),
          made(width, height, maximum), made(width, height, chequered)}) {
      const std::string encoded = encode_inverse_depth(depth);
      EXPECT_FALSE(encoded.empty());
      EXPECT_LE(encoded.size(), 2 * depth.data().size() + 1024);
      InverseDepthImage decoded(width, height, kUntouched);
      const Status status = decode_inverse_depth(bytes_of(encoded), all_of(depth), &decoded);
      ASSERT_TRUE(status) << status.error().message();
      EXPECT_EQ(decoded, depth) << width << "x" << height;
    }
  }
}

TEST(InverseDepth, is_written_to_its_cells_alone) {
  const InverseDepthImage depth = random_depth(5, 3);
  InverseDepthImage picture(12, 9, kUntouched);
  ASSERT_TRUE(decode_inverse_depth(bytes_of(encode_inverse_depth(depth)), {4, 6, 5, 3}, &picture));
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 12; ++x) {
      const bool inside = x >= 4 && x < 9 && y >= 6;
      EXPECT_EQ(*picture.at(x, y), inside ? *depth.at(x - 4, y - 6) : kUntouched) << x << ", " << y;
    }
  }
}

TEST(InverseDepth, of_rooms_needs_few_bits_a_cell) {
  const InverseDepthImage depth = room_depth(64, 64);
  EXPECT_LT(encode_inverse_depth(depth).size(), depth.data().size() / 4);
}

/// Expects the bytes to be refused with kBadData and the image to be as it was.
void expect_refused(const std::string& bytes, const PixelRect& cells, const std::string& what) {
  const InverseDepthImage before(cells.x + cells.width, cells.y + cells.height, kUntouched);
  InverseDepthImage depth = before;
  const Status status = decode_inverse_depth(bytes_of(bytes), cells, &depth);
  ASSERT_FALSE(status) << what;
  EXPECT_EQ(status.error().code(), ErrorCode::kBadData) << what;
  EXPECT_EQ(depth, before) << what;
}

TEST(InverseDepth, refuses_foreign_bytes) {
  expect_refused("", {0, 0, 4, 4}, "nothing");
  expect_refused("depth", {0, 0, 4, 4}, "text");
  expect_refused(std::string(5000, '\0'), {0, 0, 4, 4}, "zeros");
  const std::string encoded = encode_inverse_depth(random_depth(8, 6));
  expect_refused(encoded, {0, 0, 8, 7}, "too few values");
  expect_refused(encoded, {0, 0, 8, 5}, "too many values");
  expect_refused(encoded + encoded, {0, 0, 8, 6}, "twice");
  expect_refused(encoded + "x", {0, 0, 8, 6}, "more bytes");
}

TEST(InverseDepth, refuses_values_out_of_range) {
  for (const int value : {kMaxInverseDepth + 1, 5000, 32767}) {
    for (const int where : {0, 1, 11}) {
      InverseDepthImage depth(4, 3);
      depth.data()[static_cast<std::size_t>(where)] = static_cast<std::uint16_t>(value);
      expect_refused(encode_inverse_depth(depth), {2, 1, 4, 3}, std::to_string(value));
    }
  }
}

TEST(InverseDepth, never_half_writes_damaged_bytes) {
  const InverseDepthImage depth = room_depth(40, 30);
  const std::string encoded = encode_inverse_depth(depth);
  for (std::size_t kept = 0; kept < encoded.size(); ++kept) {
    expect_refused(encoded.substr(0, kept), all_of(depth), "truncated to " + std::to_string(kept));
  }
  int refused = 0;
  const InverseDepthImage before(40, 30, kUntouched);
  for (std::size_t i = 0; i < 8 * encoded.size(); ++i) {
    std::string damaged = encoded;
    damaged[i / 8] = static_cast<char>(damaged[i / 8] ^ (1 << i % 8));
    InverseDepthImage decoded = before;
    if (decode_inverse_depth(bytes_of(damaged), all_of(depth), &decoded)) {
      for (const std::uint16_t value : decoded.data()) ASSERT_LE(value, kMaxInverseDepth);
    } else {
      EXPECT_EQ(decoded, before) << "bit " << i;
      ++refused;
    }
  }
  EXPECT_GT(refused, 0);
}

}  // namespace
}  // namespace cyclorama

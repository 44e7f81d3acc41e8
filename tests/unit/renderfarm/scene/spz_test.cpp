// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/spz.h"

#include <gmock/gmock.h>
#include <zlib.h>

#include <array>
#include <cmath>

#include "renderfarm/scene/model.h"
#include "tests/data_sets/shared_data.h"
#include "tests/support/memory_file.h"

namespace cyclorama::scene {
namespace {

using ::testing::HasSubstr;

constexpr std::size_t kLimit = std::size_t{1} << 30;

void put_u32(std::string* bytes, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) *bytes += static_cast<char>(value >> shift & 255u);
}

std::string header(std::uint32_t version, std::uint32_t count, int degree) {
  std::string bytes = "NGSP";
  put_u32(&bytes, version);
  put_u32(&bytes, count);
  bytes += static_cast<char>(degree);
  bytes += '\x08';
  bytes += std::string(2, '\0');
  return bytes;
}

std::string gzip(const std::string& raw) {
  std::array<char, 4096> packed;
  z_stream stream{};
  EXPECT_EQ(deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 9, Z_DEFAULT_STRATEGY), Z_OK);
  std::string input = raw;
  stream.next_in = reinterpret_cast<Bytef*>(input.data());
  stream.avail_in = static_cast<uInt>(input.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  deflateEnd(&stream);
  return {packed.data(), packed.size() - stream.avail_out};
}

/// A splat at (1, -2, 0.5) of version 2 with harmonics of degree 1.
std::string one_splat() {
  std::string raw = header(2, 1, 1);
  raw += std::string("\x00\x01\x00\x00\xfe\xff\x80\x00\x00", 9);  // Steps of 1/256.
  raw += '\xff';
  raw += std::string("\x80\x00\xff", 3);
  raw += std::string("\xa0\xb0\x90", 3);
  raw += std::string("\xff\x80\x80", 3);  // A half turn about x.
  raw += std::string("\x00\x80\xc0\x80\x80\x80\x80\x80\x80", 9);
  return raw;
}

Result<SplatCloud> decode(const std::string& bytes, std::size_t limit = kLimit) {
  std::size_t left_out = 0;
  return decode_spz(std::as_bytes(std::span(bytes)), limit, &left_out);
}

TEST(Spz, a_splat_of_version_2_has_all_its_parts) {
  const auto cloud = decode(gzip(one_splat()));
  ASSERT_TRUE(cloud.has_value()) << cloud.error().message();
  ASSERT_EQ(cloud->size(), 1u);
  EXPECT_EQ(cloud->degree, 1);
  EXPECT_EQ(cloud->positions[0], (std::array<float, 3>{1.0f, -2.0f, 0.5f}));
  EXPECT_NEAR(cloud->scales[0][0], 1.0f, 1e-6f);
  EXPECT_NEAR(cloud->scales[0][1], std::exp(1.0f), 1e-6f);
  EXPECT_NEAR(cloud->scales[0][2], std::exp(-1.0f), 1e-6f);
  EXPECT_EQ(cloud->opacities[0], 1.0f);
  EXPECT_NEAR(cloud->rotations[0][1], 1.0f, 1e-4f);
  ASSERT_EQ(cloud->coefficients.size(), 4u);
  EXPECT_NEAR(cloud->coefficients[0][1], -0.5f / 0.15f, 1e-5f);
  EXPECT_NEAR(cloud->coefficients[0][2], 0.5f / 0.15f, 1e-5f);
  EXPECT_EQ(cloud->coefficients[1], (std::array<float, 3>{-1.0f, 0.0f, 0.5f}));
}

TEST(Spz, every_truncation_is_refused) {
  const std::string whole = gzip(one_splat());
  for (std::size_t size = 0; size < whole.size() - 8; ++size) {
    const auto cloud = decode(whole.substr(0, size));
    ASSERT_FALSE(cloud.has_value()) << size;
    EXPECT_EQ(cloud.error().code(), ErrorCode::kBadData);
  }
}

TEST(Spz, two_kilobytes_that_announce_four_billion_splats_are_refused_before_memory_is_taken) {
  for (const std::uint32_t version : {2u, 3u}) {
    const auto cloud = decode(gzip(header(version, 0xffffffff, 3) + std::string(2000, '\x42')));
    ASSERT_FALSE(cloud.has_value());
    EXPECT_THAT(cloud.error().message(), HasSubstr("announces 4294967295 splats, but has only"));
  }
  std::string streams = header(4, 0xffffffff, 0);
  streams[15] = 5;
  streams += std::string("\x20\0\0\0", 4) + std::string(2012, '\0');
  EXPECT_FALSE(decode(streams, std::size_t{64} << 20).has_value());
}

TEST(Spz, more_splats_than_the_limit_allows_are_refused) {
  const auto cloud = decode(gzip(one_splat()), 100);
  ASSERT_FALSE(cloud.has_value());
  EXPECT_THAT(cloud.error().message(), HasSubstr("need more than the 0 MiB"));
}

TEST(Spz, other_versions_degrees_and_lengths_are_refused) {
  EXPECT_THAT(decode(gzip(header(9, 0, 0))).error().message(), HasSubstr("version 9"));
  EXPECT_THAT(decode(gzip(header(2, 0, 4))).error().message(), HasSubstr("degree 4"));
  EXPECT_THAT(decode(gzip(one_splat() + "x")).error().message(), HasSubstr("does not hold the 1 splats"));
  EXPECT_THAT(decode(one_splat()).error().message(), HasSubstr("not compressed"));
}

TEST(Spz, invisible_splats_are_left_out_and_counted) {
  std::string raw = one_splat();
  raw[25] = '\0';  // Its opacity.
  std::size_t left_out = 0;
  const std::string packed = gzip(raw);
  const auto cloud = decode_spz(std::as_bytes(std::span(packed)), kLimit, &left_out);
  ASSERT_TRUE(cloud.has_value()) << cloud.error().message();
  EXPECT_EQ(cloud->size(), 0u);
  EXPECT_EQ(left_out, 1u);
}

/// The four splats of splat-transform's fixtures: at the origin and one step along each axis.
TEST(Spz, files_of_all_versions_hold_the_same_splats) {
  CYCLORAMA_SHARED_DATA(folder, "scans/splats");
  for (const char* const name : {"minimal-v2.spz", "minimal-v3.spz", "minimal-v4.spz"}) {
    const auto model = import_spz(folder / name, {});
    ASSERT_TRUE(model.has_value()) << model.error().message();
    const SplatCloud& cloud = model->splats.at(0);
    ASSERT_EQ(cloud.size(), 4u) << name;
    EXPECT_NEAR(cloud.opacities[0], 0.9f, 0.01f) << name;
    for (const std::array<float, 4>& q : cloud.rotations) {
      EXPECT_NEAR(std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3])), 1.0f, 1e-5f) << name;
    }
  }
  EXPECT_FALSE(import_spz(folder / "minimal-raw.spz", {}).has_value());
}

}  // namespace
}  // namespace cyclorama::scene

// SPDX-License-Identifier: Apache-2.0
#include "common/image/foreign_jpeg.h"

#include <gmock/gmock.h>

#include <cstdio>
#include <cstdlib>

#include <jpeglib.h>

#include "common/image/jpeg.h"

namespace cyclorama {
namespace {

using ::testing::HasSubstr;

constexpr std::size_t kLimitPx = 1 << 20;
constexpr int kWidth = 70;
constexpr int kHeight = 50;

struct Way {
  J_COLOR_SPACE stored = JCS_YCbCr;
  int across = 1;  ///< Luma samples for each of chroma.
  int down = 1;
  bool adobe = false;
};

/// Encodes one colour in the components that libjpeg is given for `way`.
std::vector<std::byte> encoded(const std::vector<std::uint8_t>& colour, const Way& way) {
  jpeg_compress_struct info{};
  jpeg_error_mgr manager{};
  info.err = jpeg_std_error(&manager);
  jpeg_create_compress(&info);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&info, &bytes, &size);
  info.image_width = kWidth;
  info.image_height = kHeight;
  info.input_components = static_cast<int>(colour.size());
  info.in_color_space = colour.size() == 4 ? JCS_CMYK : JCS_RGB;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, 100, TRUE);
  jpeg_set_colorspace(&info, way.stored);
  info.write_Adobe_marker = way.adobe ? TRUE : FALSE;
  info.comp_info[0].h_samp_factor = way.across;
  info.comp_info[0].v_samp_factor = way.down;
  jpeg_start_compress(&info, TRUE);
  std::vector<std::uint8_t> row;
  for (int x = 0; x < kWidth; ++x) row.insert(row.end(), colour.begin(), colour.end());
  for (int y = 0; y < kHeight; ++y) {
    JSAMPROW rows = row.data();
    jpeg_write_scanlines(&info, &rows, 1);
  }
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  const auto* const begin = reinterpret_cast<const std::byte*>(bytes);
  std::vector<std::byte> file(begin, begin + size);
  std::free(bytes);
  return file;
}

void expect_colour(std::span<const std::byte> jpeg, const std::array<int, 3>& rgb) {
  const auto image = decode_foreign_jpeg(jpeg, kLimitPx);
  ASSERT_TRUE(image.has_value()) << image.error().message();
  ASSERT_EQ(image->width(), kWidth);
  ASSERT_EQ(image->height(), kHeight);
  for (const int x : {0, kWidth - 1}) {
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(image->at(x, kHeight - 1)[c], rgb[c], 3) << x << ", " << c;
    EXPECT_EQ(image->at(x, 0)[3], 255);
  }
}

TEST(ForeignJpeg, any_sampling_of_the_colours_is_read) {
  for (const auto& [across, down] : {std::pair{1, 1}, std::pair{2, 1}, std::pair{2, 2}, std::pair{4, 1},
                                     std::pair{4, 2}, std::pair{1, 2}, std::pair{1, 4}}) {
    SCOPED_TRACE(std::to_string(across) + "x" + std::to_string(down));
    expect_colour(encoded({200, 100, 50}, {.across = across, .down = down}), {200, 100, 50});
  }
}

TEST(ForeignJpeg, cmyk_becomes_the_colour_that_the_ink_leaves_of_white_paper) {
  // Ink of 0, 50 and 100 %; a fifth of black.
  expect_colour(encoded({0, 128, 255, 51}, {.stored = JCS_CMYK}), {204, 102, 0});
  expect_colour(encoded({255, 127, 0, 204}, {.stored = JCS_CMYK, .adobe = true}), {204, 102, 0});
  expect_colour(encoded({255, 127, 0, 204}, {.stored = JCS_YCCK, .adobe = true}), {204, 102, 0});
}

TEST(ForeignJpeg, bytes_between_segments_are_skipped_and_damage_is_refused) {
  const std::vector<std::byte> whole = encoded({200, 100, 50}, {});
  std::vector<std::byte> stuffed = whole;
  stuffed.insert(stuffed.begin() + 2, 5, std::byte{0});
  expect_colour(stuffed, {200, 100, 50});
  for (const std::size_t size : {whole.size() - 2, whole.size() / 2, std::size_t{100}, std::size_t{3}}) {
    EXPECT_FALSE(decode_foreign_jpeg(std::span(whole).first(size), kLimitPx).has_value()) << size;
  }
  std::vector<std::byte> damaged = whole;
  damaged[whole.size() - 20] = std::byte{0xff};
  damaged[whole.size() - 19] = std::byte{0xd9};  // The end, too early.
  EXPECT_FALSE(decode_foreign_jpeg(damaged, kLimitPx).has_value());
}

TEST(ForeignJpeg, is_equal_to_the_wires_decoder_where_both_read_a_picture) {
  RgbImage image(33, 21);
  for (std::size_t i = 0; i < image.data().size(); ++i) image.data()[i] = static_cast<std::uint8_t>(i * 37 % 251);
  const auto jpeg = JpegEncoder().encode(image, {});
  const auto ours = decode_foreign_jpeg(*jpeg, kLimitPx);
  const auto theirs = JpegDecoder().decode(*jpeg, kLimitPx);
  ASSERT_TRUE(ours.has_value() && theirs.has_value());
  for (std::size_t i = 0; i < theirs->data().size(); ++i) {
    ASSERT_EQ(ours->data()[i / 3 * 4 + i % 3], theirs->data()[i]) << i;
  }
}

TEST(ForeignJpeg, too_many_pixels_are_refused_with_their_number) {
  const auto image = decode_foreign_jpeg(encoded({1, 2, 3}, {}), 100);
  ASSERT_FALSE(image.has_value());
  EXPECT_THAT(image.error().message(), HasSubstr("70x50 pixels; at most 100"));
}

}  // namespace
}  // namespace cyclorama

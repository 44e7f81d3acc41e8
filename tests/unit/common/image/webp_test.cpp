// SPDX-License-Identifier: Apache-2.0
#include "common/image/webp.h"

#include <gmock/gmock.h>
#include <webp/encode.h>

#include "common/image/image_file.h"

namespace cyclorama {
namespace {

using ::testing::HasSubstr;

RgbaImage picture() {
  RgbaImage image(19, 7);
  for (std::size_t i = 0; i < image.data().size(); ++i) image.data()[i] = static_cast<std::uint8_t>(i * 7 % 256);
  return image;
}

/// Lossless, so that it comes back as it was where it is not transparent.
std::vector<std::byte> lossless(RgbaImage image) {
  for (std::size_t i = 3; i < image.data().size(); i += 4) image.data()[i] |= 1;
  std::uint8_t* bytes = nullptr;
  const std::size_t size = WebPEncodeLosslessRGBA(image.data().data(), image.width(), image.height(),
                                                  static_cast<int>(image.row_values()), &bytes);
  const auto* const begin = reinterpret_cast<const std::byte*>(bytes);
  std::vector<std::byte> file(begin, begin + size);
  WebPFree(bytes);
  return file;
}

TEST(Webp, a_lossless_picture_survives_a_round_trip_with_its_alpha) {
  const auto back = decode_image(lossless(picture()), 1000);
  ASSERT_TRUE(back.has_value()) << back.error().message();
  ASSERT_EQ(back->width(), 19);
  ASSERT_EQ(back->height(), 7);
  for (std::size_t i = 0; i < back->data().size(); ++i) {
    ASSERT_EQ(back->data()[i], i % 4 == 3 ? picture().data()[i] | 1 : picture().data()[i]) << i;
  }
}

TEST(Webp, every_truncation_is_refused) {
  const std::vector<std::byte> whole = lossless(picture());
  for (std::size_t size = 0; size < whole.size() - 1; ++size) {
    const auto image = decode_webp(std::span(whole).first(size), 1000);
    ASSERT_FALSE(image.has_value()) << size;
    EXPECT_EQ(image.error().code(), ErrorCode::kBadData);
  }
}

TEST(Webp, too_many_pixels_are_refused_with_their_number) {
  const auto image = decode_webp(lossless(picture()), 100);
  ASSERT_FALSE(image.has_value());
  EXPECT_THAT(image.error().message(), HasSubstr("19x7 pixels; at most 100"));
}

}  // namespace
}  // namespace cyclorama

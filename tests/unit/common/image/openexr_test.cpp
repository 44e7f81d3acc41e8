// SPDX-License-Identifier: Apache-2.0
#include "common/image/openexr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "common/base/file.h"
#include "common/image/radiance_file.h"
#include "tests/data_sets/shared_data.h"

namespace cyclorama {
namespace {

constexpr std::size_t kLimitPx = std::size_t{1} << 22;
constexpr int kWidth = 37;
constexpr int kHeight = 21;

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

struct Written {
  std::vector<std::string> channels{"R", "G", "B"};
  Imf::Compression compression = Imf::ZIP_COMPRESSION;
  bool tiled = false;
  bool cropped = false;
};

/// Channel c of pixel (x, y) is 1000 c + 37 y + x, but pixel (1, 0) is NaN, (2, 0) infinite, (3, 0) negative.
std::string write(const Written& how) {
  Imf::Header header(kWidth, kHeight);
  header.compression() = how.compression;
  if (how.cropped) header.displayWindow().max.x += 10;
  std::vector<std::vector<float>> values;
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < how.channels.size(); ++c) {
    std::vector<float>& plane = values.emplace_back();
    for (int i = 0; i < kWidth * kHeight; ++i) plane.push_back(static_cast<float>(1000 * static_cast<int>(c) + i));
    plane[1] = std::numeric_limits<float>::quiet_NaN();
    plane[2] = std::numeric_limits<float>::infinity();
    plane[3] = -4.0f;
    header.channels().insert(how.channels[c], Imf::Channel(Imf::FLOAT));
    buffer.insert(how.channels[c], Imf::Slice::Make(Imf::FLOAT, plane.data(), header.dataWindow()));
  }
  Imf::StdOSStream stream;
  if (how.tiled) {
    header.setTileDescription(Imf::TileDescription(16, 8));
    Imf::TiledOutputFile file(stream, header, 0);
    file.setFrameBuffer(buffer);
    file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
  } else {
    Imf::OutputFile file(stream, header, 0);
    file.setFrameBuffer(buffer);
    file.writePixels(kHeight);
  }
  return stream.str();
}

TEST(OpenExr, reads_every_lossless_compression_in_rows_and_tiles) {
  for (const Imf::Compression compression :
       {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION}) {
    for (const bool tiled : {false, true}) {
      const std::string file = write({.compression = compression, .tiled = tiled});
      const auto image = decode_openexr(bytes_of(file), kLimitPx);
      ASSERT_TRUE(image.has_value()) << image.error().message();
      ASSERT_EQ(image->width(), kWidth);
      ASSERT_EQ(image->height(), kHeight);
      for (int i = 4; i < kWidth * kHeight; ++i) {
        for (int c = 0; c < 3; ++c) ASSERT_EQ(image->at(i % kWidth, i / kWidth)[c], static_cast<float>(1000 * c + i));
      }
    }
  }
}

TEST(OpenExr, replaces_invalid_light) {
  const std::string file = write({});
  const auto image = decode_openexr(bytes_of(file), kLimitPx);
  ASSERT_TRUE(image.has_value());
  EXPECT_EQ(image->at(1, 0)[0], 0.0f);
  EXPECT_EQ(image->at(2, 0)[1], kMaxHalf);
  EXPECT_EQ(image->at(3, 0)[2], 0.0f);
}

TEST(OpenExr, reads_luminance_alone_as_grey_and_ignores_alpha) {
  const std::string grey = write({.channels = {"Y"}});
  const auto image = decode_openexr(bytes_of(grey), kLimitPx);
  ASSERT_TRUE(image.has_value()) << image.error().message();
  for (int c = 0; c < 3; ++c) EXPECT_EQ(image->at(5, 2)[c], static_cast<float>(2 * kWidth + 5));
  const std::string with_alpha = write({.channels = {"R", "G", "B", "A"}});
  EXPECT_TRUE(decode_openexr(bytes_of(with_alpha), kLimitPx).has_value());
}

TEST(OpenExr, refuses_other_layouts_by_name) {
  const auto message = [](const Written& how) {
    const std::string file = write(how);
    const auto image = decode_openexr(bytes_of(file), kLimitPx);
    return image ? std::string() : image.error().message();
  };
  EXPECT_NE(message({.channels = {"Z"}}).find("R, G and B"), std::string::npos);
  EXPECT_NE(message({.channels = {"Y", "RY", "BY"}}).find("R, G and B"), std::string::npos);
  EXPECT_NE(message({.channels = {"left.R", "left.G", "left.B"}}).find("R, G and B"), std::string::npos);
  EXPECT_NE(message({.cropped = true}).find("uncropped"), std::string::npos);
}

TEST(OpenExr, refuses_truncated_and_oversized_files) {
  const std::string file = write({.tiled = false});
  for (std::size_t length = 0; length < file.size(); ++length) {
    const auto image = decode_openexr(bytes_of(file.substr(0, length)), kLimitPx);
    ASSERT_FALSE(image.has_value()) << length;
    EXPECT_EQ(image.error().code(), ErrorCode::kBadData);
  }
  EXPECT_FALSE(decode_openexr(bytes_of(file), kWidth * kHeight - 1).has_value());
  EXPECT_TRUE(decode_openexr(bytes_of(file), kWidth * kHeight).has_value());
}

TEST(OpenExr, refuses_an_attribute_longer_than_the_file_before_allocating_memory) {
  std::string file = write({});
  const std::size_t length = file.find("compression") + 2 * sizeof("compression");
  file[length + 3] = 0x7f;
  const auto image = decode_openexr(bytes_of(file), kLimitPx);
  ASSERT_FALSE(image.has_value());
  EXPECT_NE(image.error().message().find("byte"), std::string::npos) << image.error().message();
}

TEST(OpenExr, reads_photographs_by_content_and_refuses_damaged_files_in_one_sentence) {
  CYCLORAMA_SHARED_DATA(courtyard, "hdri/courtyard.exr");
  const auto image = read_radiance(courtyard, kLimitPx);
  ASSERT_TRUE(image.has_value()) << image.error().message();
  EXPECT_EQ(image->width(), 1024);
  EXPECT_EQ(image->height(), 512);
  const auto file = read_file(courtyard, std::size_t{1} << 24);
  for (std::size_t length = 0; length < file->size(); length += 29989) {
    EXPECT_FALSE(decode_radiance(std::span(*file).first(length), kLimitPx).has_value()) << length;
  }
  CYCLORAMA_SHARED_DATA(bad, "bad/openexr");
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(bad)) {
    if (entry.path().extension() != ".exr") continue;
    ++files;
    const auto damaged = read_radiance(entry.path(), kLimitPx);
    ASSERT_FALSE(damaged.has_value()) << entry.path();
    EXPECT_EQ(damaged.error().code(), ErrorCode::kBadData);
    EXPECT_NE(damaged.error().message().find(entry.path().string()), std::string::npos);
    EXPECT_EQ(damaged.error().message().find('\n'), std::string::npos);
    std::printf("%s\n", damaged.error().message().c_str());
  }
  EXPECT_GT(files, 0);
}

}  // namespace
}  // namespace cyclorama

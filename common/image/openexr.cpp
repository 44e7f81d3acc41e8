// SPDX-License-Identifier: Apache-2.0
#include "common/image/openexr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStdIO.h>
#include <ImfTileDescription.h>
#include <ImfVersion.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <exception>
#include <string>
#include <string_view>

#include "common/base/text.h"
#include "common/image/radiance_file.h"

namespace cyclorama {
namespace {

constexpr std::size_t kPrologueBytes = 8;  ///< Magic number and version.
constexpr std::int64_t kMaxSidePx = 65536;
constexpr int kMaxChannels = 32;
constexpr std::uint64_t kMaxTilePixels = std::uint64_t{4096} * 4096;

Error bad(std::string_view what) { return Error(ErrorCode::kBadData, fmt::format("OpenEXR: {}", what)); }

/// Checks the header's attributes, because the library allocates memory for an attribute before it checks that the file
/// contains that much data. The header is a list of name, type (both zero-terminated), length and value, and ends with
/// an empty name.
Status check_attributes(std::string_view text) {
  std::size_t at = kPrologueBytes;
  const auto broken = [&] { return bad(fmt::format("byte {}: the header is cut short; copy the picture again", at)); };
  while (at < text.size() && text[at] != '\0') {
    for (int word = 0; word < 2; ++word) {
      const std::size_t end = text.find('\0', at);
      if (end == std::string_view::npos) return broken();
      at = end + 1;
    }
    std::uint32_t length = 0;
    if (text.size() - at < sizeof(length)) return broken();
    // The length is little-endian, like every supported machine.
    std::memcpy(&length, text.data() + at, sizeof(length));
    at += sizeof(length);
    if (length > text.size() - at) return broken();
    at += length;
  }
  return at < text.size() ? Status(Done{}) : broken();
}

/// Checks the sizes for which the library allocates memory when it opens the file.
Status check_size(const Imf::Header& header, std::size_t limit_px) {
  const Imath::Box2i& data = header.dataWindow();
  const std::int64_t width = std::int64_t{data.max.x} - data.min.x + 1;
  const std::int64_t height = std::int64_t{data.max.y} - data.min.y + 1;
  if (width < 1 || height < 1 || width > kMaxSidePx || height > kMaxSidePx ||
      static_cast<std::size_t>(width * height) > limit_px) {
    return bad(fmt::format("the picture has {}x{} pixels; at most {} are accepted here; make it smaller", width, height,
                           limit_px));
  }
  if (data != header.displayWindow()) return bad("only a part of the picture is stored; save it uncropped");
  int channels = 0;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) ++channels;
  if (channels > kMaxChannels) {
    return bad(fmt::format("it has more than {} channels; save R, G and B alone", kMaxChannels));
  }
  if (header.hasTileDescription()) {
    const Imf::TileDescription& tiles = header.tileDescription();
    if (std::uint64_t{tiles.xSize} * tiles.ySize > kMaxTilePixels) {
      return bad(fmt::format("its tiles are {}x{} pixels; save it in rows", tiles.xSize, tiles.ySize));
    }
  }
  return Done{};
}

Result<RadianceImage> read_pixels(Imf::InputFile* file) {
  const Imf::Header& header = file->header();
  const bool colour = header.channels().findChannel("R") != nullptr && header.channels().findChannel("G") != nullptr &&
                      header.channels().findChannel("B") != nullptr;
  const bool has_chroma =
      header.channels().findChannel("RY") != nullptr || header.channels().findChannel("BY") != nullptr;
  if (!colour && (header.channels().findChannel("Y") == nullptr || has_chroma)) {
    return bad("it has no channels named R, G and B; save it with them");
  }
  const Imath::Box2i& data = header.dataWindow();
  RadianceImage image(data.max.x - data.min.x + 1, data.max.y - data.min.y + 1);
  Imf::FrameBuffer buffer;
  const auto add = [&](const char* name, std::size_t channel) {
    buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, image.data().data() + channel, data, 3 * sizeof(float),
                                         image.row_values() * sizeof(float)));
  };
  if (colour) {
    add("R", 0);
    add("G", 1);
    add("B", 2);
  } else {
    add("Y", 0);
  }
  file->setFrameBuffer(buffer);
  file->readPixels(data.min.y, data.max.y);
  for (std::size_t i = 0; i < image.data().size(); i += 3) {
    const std::span<float> texel = image.data().subspan(i, 3);
    if (!colour) texel[1] = texel[2] = texel[0];
    for (float& value : texel) value = sane_radiance(value);
  }
  return image;
}

Result<RadianceImage> decode(std::span<const std::byte> bytes, std::size_t limit_px) {
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (bytes.size() < kPrologueBytes || !Imf::isImfMagic(text.data())) return bad("this is no OpenEXR picture");
  std::int32_t version = 0;
  std::memcpy(&version, text.data() + 4, sizeof(version));
  if (Imf::isMultiPart(version) || Imf::isNonImage(version)) {
    return bad("it holds several parts or deep pixels; save one flat picture");
  }
  TRY(check_attributes(text));
  Imf::StdISStream stream;
  stream.str(text);
  {
    stream.seekg(kPrologueBytes);
    Imf::Header header;
    header.readFrom(stream, version);
    TRY(check_size(header, limit_px));
    stream.seekg(0);
  }
  Imf::InputFile file(stream, 0);  // The library starts no threads.
  return read_pixels(&file);
}

}  // namespace

Result<RadianceImage> decode_openexr(std::span<const std::byte> bytes, std::size_t limit_px) {
  try {
    return decode(bytes, limit_px);
  } catch (const std::exception& e) {
    return bad(fmt::format("{}; copy or export the picture again", printable(e.what(), 200)));
  }
}

}  // namespace cyclorama

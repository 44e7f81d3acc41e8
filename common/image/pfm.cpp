// SPDX-License-Identifier: Apache-2.0
#include "common/image/pfm.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>

#include "common/base/file.h"
#include "common/base/text.h"

namespace cyclorama {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";
constexpr std::size_t kHeaderLimitBytes = 1024;

Error bad(std::size_t offset, std::string_view what) {
  return Error(ErrorCode::kBadData, fmt::format("byte {}: {}", offset, what));
}

/// Takes the next word of the header, and the one blank that ends it. Returns an empty word at the end of the bytes.
std::string_view take_word(std::string_view header, std::size_t* offset) {
  const std::size_t begin = std::min(header.find_first_not_of(kBlanks, *offset), header.size());
  const std::size_t end = std::min(header.find_first_of(kBlanks, begin), header.size());
  *offset = std::min(end + 1, header.size());
  return header.substr(begin, end - begin);
}

std::uint32_t in_order(std::uint32_t bits, bool little) {
  if (little == (std::endian::native == std::endian::little)) return bits;
  return bits >> 24 | (bits >> 8 & 0xff00u) | (bits << 8 & 0xff0000u) | bits << 24;
}

}  // namespace

Result<RadianceImage> decode_pfm(std::span<const std::byte> pfm, std::size_t limit_px) {
  const std::string_view header(reinterpret_cast<const char*>(pfm.data()), std::min(pfm.size(), kHeaderLimitBytes));
  std::size_t offset = 0;
  const std::string_view magic = take_word(header, &offset);
  if (magic != "PF" && magic != "Pf") return bad(0, "this is no PFM picture; convert it to PFM");
  std::array<int, 2> size{};
  for (int& side : size) {
    const auto value = parse_integer(take_word(header, &offset));
    if (!value || *value < 1 || *value > std::numeric_limits<int>::max()) {
      return bad(offset, "the PFM header states no size; write the file again");
    }
    side = static_cast<int>(*value);
  }
  const auto scale = parse_double(take_word(header, &offset));
  if (!scale || !(*scale < 0.0 || *scale > 0.0)) {
    return bad(offset, "the PFM header ends without a scale; write the file again");
  }
  const auto [width, height] = size;
  if (static_cast<std::size_t>(width) > limit_px / static_cast<std::size_t>(height)) {
    return bad(offset, fmt::format("the PFM has {}x{} pixels; at most {} are accepted here", width, height, limit_px));
  }
  const std::size_t in_channels = magic == "PF" ? 3 : 1;
  const std::size_t need =
      in_channels * sizeof(float) * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (pfm.size() - offset != need) {
    return bad(offset, fmt::format("{} bytes of pixels follow and {}x{} of them need {}; copy the file again",
                                   pfm.size() - offset, width, height, need));
  }
  RadianceImage image(width, height);
  const std::byte* in = pfm.data() + offset;
  for (int y = height - 1; y >= 0; --y) {  // The last row is stored first.
    float* out = image.at(0, y);
    for (int i = 0; i < 3 * width; ++i) {
      std::uint32_t bits = 0;
      std::memcpy(&bits, in, sizeof(bits));
      out[i] = std::bit_cast<float>(in_order(bits, *scale < 0.0));
      if (in_channels == 3 || i % 3 == 2) in += sizeof(bits);
    }
  }
  return image;
}

Result<RadianceImage> read_pfm(const std::filesystem::path& path, std::size_t limit_px) {
  TRY_ASSIGN(const MappedFile file, MappedFile::open(path));
  auto image = decode_pfm(file.bytes(), limit_px);
  if (!image) return std::move(image).error().while_doing(fmt::format("reading picture '{}'", path.string()));
  return image;
}

std::vector<std::byte> encode_pfm(const RadianceImage& image) {
  CHECK(!image.empty());
  const std::string header = fmt::format("PF\n{} {}\n-1.0\n", image.width(), image.height());
  std::vector<std::byte> pfm(header.size() + sizeof(float) * image.data().size());
  std::memcpy(pfm.data(), header.data(), header.size());
  std::byte* out = pfm.data() + header.size();
  for (int y = image.height() - 1; y >= 0; --y) {
    const float* const row = image.at(0, y);
    for (std::size_t i = 0; i < image.row_values(); ++i, out += sizeof(float)) {
      const std::uint32_t bits = in_order(std::bit_cast<std::uint32_t>(row[i]), true);
      std::memcpy(out, &bits, sizeof(bits));
    }
  }
  return pfm;
}

Status write_pfm(const std::filesystem::path& path, const RadianceImage& image) {
  if (image.empty()) return Error(ErrorCode::kInvalidArgument, "an empty picture cannot be written as PFM");
  return write_file_atomically(path, encode_pfm(image));
}

}  // namespace cyclorama

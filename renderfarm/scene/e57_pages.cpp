// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/e57_pages.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "renderfarm/scene/little_endian.h"

namespace cyclorama::scene {
namespace {

constexpr std::size_t kChecksumBytes = 4;
constexpr std::size_t kE57HeaderBytes = 48;

/// CRC-32C (Castagnoli), reflected, as in iSCSI (RFC 3720).
std::uint32_t crc32c(std::span<const std::byte> bytes) {
  static constexpr auto kTable = [] {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t i = 0; i < table.size(); ++i) {
      std::uint32_t value = i;
      for (int bit = 0; bit < 8; ++bit) value = (value & 1u) != 0 ? value >> 1 ^ 0x82f63b78u : value >> 1;
      table[i] = value;
    }
    return table;
  }();
  std::uint32_t crc = ~0u;
  for (const std::byte byte : bytes) crc = crc >> 8 ^ kTable[(crc ^ static_cast<std::uint32_t>(byte)) & 255u];
  return ~crc;
}

Error bad_e57_page(std::string what) { return Error(ErrorCode::kBadData, std::move(what)); }

}  // namespace

Result<E57Pages> E57Pages::open(std::span<const std::byte> file) {
  if (file.size() < kE57HeaderBytes || std::memcmp(file.data(), "ASTM-E57", 8) != 0) {
    return bad_e57_page("this is not an E57 file: it has no header of E57; copy it again");
  }
  E57Pages pages;
  pages.file_ = file;
  const auto major = little_endian<std::uint32_t>(file, 8);
  const auto length = little_endian<std::uint64_t>(file, 16);
  const auto xml_at = little_endian<std::uint64_t>(file, 24);
  pages.xml_bytes_ = little_endian<std::uint64_t>(file, 32);
  pages.page_bytes_ = little_endian<std::uint64_t>(file, 40);
  if (major != 1) return bad_e57_page(fmt::format("it is of E57's version {}; version 1 can be read", major));
  constexpr std::uint64_t kMaxPageBytes = std::uint64_t{1} << 20;
  if (pages.page_bytes_ <= kE57HeaderBytes || pages.page_bytes_ > kMaxPageBytes) {
    return bad_e57_page(fmt::format("its pages have {} bytes, which is no size of E57", pages.page_bytes_));
  }
  if (length > file.size()) {
    return bad_e57_page(
        fmt::format("it should have {} bytes and has {}: it is cut short; copy it again", length, file.size()));
  }
  pages.xml_offset_ = pages.content_offset(xml_at);
  return pages;
}

std::uint64_t E57Pages::content_offset(std::uint64_t file_offset) const {
  const std::uint64_t content_bytes = page_bytes_ - kChecksumBytes;
  return file_offset / page_bytes_ * content_bytes + std::min(file_offset % page_bytes_, content_bytes);
}

std::uint64_t E57Pages::content_bytes() const { return file_.size() / page_bytes_ * (page_bytes_ - kChecksumBytes); }

Status E57Pages::check_page(std::uint64_t page) const {
  const auto content_bytes = page_bytes_ - kChecksumBytes;
  const auto bytes = file_.subspan(page * page_bytes_, page_bytes_);
  // The checksum is the only big-endian number of an E57 file.
  const std::uint32_t stored = __builtin_bswap32(little_endian<std::uint32_t>(bytes, content_bytes));
  if (stored == crc32c(bytes.first(content_bytes))) return Done{};
  return bad_e57_page(
      fmt::format("the checksum of the page at byte {} is wrong: it is damaged; copy it again", page * page_bytes_));
}

Result<std::vector<std::byte>> E57Pages::read(std::uint64_t offset, std::uint64_t size) const {
  const std::uint64_t content_bytes = page_bytes_ - kChecksumBytes;
  const std::uint64_t end = this->content_bytes();
  if (offset > end || size > end - offset) {
    return bad_e57_page(
        fmt::format("it ends before {} bytes at {} of its content: it is cut short; copy it again", size, offset));
  }
  std::vector<std::byte> read;
  read.reserve(size);
  while (read.size() < size) {
    const std::uint64_t at = offset + read.size();
    const std::uint64_t page = at / content_bytes;
    TRY(check_page(page));
    const std::uint64_t skipped = at % content_bytes;
    const std::uint64_t some = std::min(content_bytes - skipped, size - read.size());
    const auto part = file_.subspan(page * page_bytes_ + skipped, some);
    read.insert(read.end(), part.begin(), part.end());
  }
  return read;
}

}  // namespace cyclorama::scene

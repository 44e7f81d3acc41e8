// SPDX-License-Identifier: Apache-2.0
/// Writes E57 files: cuts the content into pages and adds their checksums.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

namespace cyclorama {

inline constexpr std::size_t kE57PageBytes = 1024;
inline constexpr std::size_t kE57ContentBytes = kE57PageBytes - 4;
inline constexpr std::size_t kE57HeaderBytes = 48;

template <typename Number>
void put_number(std::string* bytes, Number value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes->append(raw, sizeof value);
}

/// Computes the checksum bit by bit, unlike the reader, so that the two are independent.
inline std::uint32_t slow_crc32c(const char* bytes, std::size_t size) {
  std::uint32_t crc = ~0u;
  for (std::size_t i = 0; i < size; ++i) {
    crc ^= static_cast<unsigned char>(bytes[i]);
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1u) != 0 ? crc >> 1 ^ 0x82f63b78u : crc >> 1;
  }
  return ~crc;
}

/// Cuts the content, which begins with space for the header, into pages.
inline std::string e57_pages_of(std::string content) {
  content.resize((content.size() + kE57ContentBytes - 1) / kE57ContentBytes * kE57ContentBytes);
  std::string file;
  for (std::size_t at = 0; at < content.size(); at += kE57ContentBytes) {
    file += content.substr(at, kE57ContentBytes);
    const std::uint32_t crc = slow_crc32c(content.data() + at, kE57ContentBytes);
    for (int shift = 24; shift >= 0; shift -= 8) file += static_cast<char>(crc >> shift & 255u);
  }
  return file;
}

/// Builds a file with one scan: packets, and the XML that describes them.
struct E57Builder {
  std::string xml_before = "<?xml version=\"1.0\"?><e57Root type=\"Structure\"><data3D type=\"Vector\"><vectorChild>";
  std::string scan;       ///< Other children of the scan, such as its pose.
  std::string prototype;  ///< Fields of the points.
  std::string packets;
  std::uint64_t count = 0;

  [[nodiscard]] std::string file() const {
    std::string content(kE57HeaderBytes, '\0');
    content += '\1';
    content.append(7, '\0');
    put_number(&content, std::uint64_t{32 + packets.size()});
    put_number(&content, std::uint64_t{kE57HeaderBytes + 32});
    put_number(&content, std::uint64_t{0});
    content += packets;
    const std::size_t xml_at = content.size();
    content += xml_before + scan + "<points type=\"CompressedVector\" fileOffset=\"" + std::to_string(kE57HeaderBytes) +
               "\" recordCount=\"" + std::to_string(count) + "\"><prototype type=\"Structure\">" + prototype +
               "</prototype></points></vectorChild></data3D></e57Root>";
    const std::size_t xml_bytes = content.size() - xml_at;
    std::string header = "ASTM-E57";
    put_number(&header, std::uint32_t{1});
    put_number(&header, std::uint32_t{0});
    const std::uint64_t pages = (content.size() + kE57ContentBytes - 1) / kE57ContentBytes;
    put_number(&header, pages * kE57PageBytes);
    put_number(&header, std::uint64_t{xml_at / kE57ContentBytes * kE57PageBytes + xml_at % kE57ContentBytes});
    put_number(&header, std::uint64_t{xml_bytes});
    put_number(&header, std::uint64_t{kE57PageBytes});
    content.replace(0, kE57HeaderBytes, header);
    return e57_pages_of(content);
  }

  /// Appends a data packet with these streams.
  void add_packet(std::initializer_list<std::string> streams) {
    std::string packet;
    put_number(&packet, static_cast<std::uint16_t>(streams.size()));
    for (const std::string& stream : streams) put_number(&packet, static_cast<std::uint16_t>(stream.size()));
    for (const std::string& stream : streams) packet += stream;
    while (packet.size() % 4 != 0) packet += '\0';
    packets += '\1';
    packets += '\0';
    put_number(&packets, static_cast<std::uint16_t>(packet.size() + 3));
    packets += packet;
  }
};

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/obj_text.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "common/base/text.h"

namespace cyclorama {
namespace {

void append_utf8(char32_t c, std::string* text) {
  const auto put = [&](char32_t byte) { text->push_back(static_cast<char>(static_cast<std::uint8_t>(byte))); };
  if (c < 0x80) return put(c);
  if (c < 0x800) {
    put(0xC0 | (c >> 6));
  } else if (c < 0x10000) {
    put(0xE0 | (c >> 12));
    put(0x80 | ((c >> 6) & 0x3F));
  } else {
    put(0xF0 | (c >> 18));
    put(0x80 | ((c >> 12) & 0x3F));
    put(0x80 | ((c >> 6) & 0x3F));
  }
  put(0x80 | (c & 0x3F));
}

std::string utf8_of_utf16(std::span<const std::byte> bytes, bool big_endian) {
  const auto unit = [&](std::size_t i) {
    const auto first = std::to_integer<std::uint32_t>(bytes[i]);
    const auto second = std::to_integer<std::uint32_t>(bytes[i + 1]);
    return static_cast<char32_t>(big_endian ? first << 8 | second : second << 8 | first);
  };
  std::string text;
  text.reserve(bytes.size() / 2);
  for (std::size_t i = 2; i + 1 < bytes.size(); i += 2) {
    char32_t c = unit(i);
    const bool is_high = c >= 0xD800 && c < 0xDC00;
    if (is_high && i + 3 < bytes.size()) {
      const char32_t low = unit(i + 2);
      if (low >= 0xDC00 && low < 0xE000) {
        c = 0x10000 + ((c - 0xD800) << 10) + (low - 0xDC00);
        i += 2;
      }
    }
    if (c >= 0xD800 && c < 0xE000) c = U'?';  // Half of a surrogate pair.
    append_utf8(c, &text);
  }
  return text;
}

}  // namespace

std::string_view to_utf8(std::span<const std::byte> bytes, std::string* storage) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with("\xEF\xBB\xBF")) return text.substr(3);
  if (!text.starts_with("\xFE\xFF") && !text.starts_with("\xFF\xFE")) return text;
  *storage = utf8_of_utf16(bytes, text.starts_with("\xFE\xFF"));
  return *storage;
}

bool ObjStatements::next(std::string_view* ret_keyword, std::string_view* ret_rest) {
  std::string_view line;
  while (lines_.next(&line)) {
    ++line_;
    if (line.ends_with('\\')) {
      joined_.clear();
      bool more = true;
      while (more && line.ends_with('\\')) {
        joined_.append(line.substr(0, line.size() - 1)).push_back(' ');
        more = lines_.next(&line);
        if (more) ++line_;
      }
      if (more) joined_.append(line);
      line = joined_;
    }
    line = line.substr(0, line.find('#'));
    *ret_keyword = next_word(&line);
    *ret_rest = trimmed(line);
    if (!ret_keyword->empty()) return true;
  }
  return false;
}

ObjCornerWords obj_corner(std::string_view word) {
  const auto up_to_slash = [&] {
    const std::size_t slash = std::min(word.find('/'), word.size());
    const std::string_view part = word.substr(0, slash);
    word.remove_prefix(std::min(slash + 1, word.size()));
    return part;
  };
  ObjCornerWords words;
  words.vertex = up_to_slash();
  words.texture = up_to_slash();
  words.normal = up_to_slash();
  words.beyond = word;
  return words;
}

std::optional<std::uint32_t> obj_index(std::string_view word, std::size_t so_far, std::size_t in_all) {
  const auto number = parse_integer(word);
  if (!number || *number == 0) return std::nullopt;
  const long long index = *number > 0 ? *number - 1 : static_cast<long long>(so_far) + *number;
  if (index < 0 || std::cmp_greater_equal(index, in_all)) return std::nullopt;
  return static_cast<std::uint32_t>(index);
}

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
/// Lines and words of text formats, without copying.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace cyclorama {

/// Splits a text into lines. A line ends at "\n", at "\r\n" and, until the first "\n", also at "\r" alone, so that
/// binary data that begins with a newline after a header with "\r" keeps its first byte. Borrows the text.
/// Thread-bound.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : text_(text) {}

  /// Sets `*ret_line` to the next line without its end. Returns false after the last one. A last line without an end
  /// counts.
  bool next(std::string_view* ret_line) {
    if (offset_ >= text_.size()) return false;
    const std::size_t end = text_.find_first_of("\r\n", offset_);
    if (end == std::string_view::npos) {
      *ret_line = text_.substr(offset_);
      offset_ = text_.size();
      return true;
    }
    *ret_line = text_.substr(offset_, end - offset_);
    offset_ = end + 1;
    if (text_[end] == '\n') {
      seen_newline_ = true;
    } else if (offset_ < text_.size() && text_[offset_] == '\n' && (seen_newline_ || !seen_return_)) {
      ++offset_;
      seen_newline_ = true;
    } else {
      seen_return_ = true;
    }
    return true;
  }
  /// Offset of the byte after the last line's end.
  [[nodiscard]] std::size_t offset() const { return offset_; }

 private:
  std::string_view text_;
  std::size_t offset_ = 0;
  bool seen_newline_ = false;
  bool seen_return_ = false;
};

inline constexpr std::string_view kBlanks = " \t\v\f\r\n";

[[nodiscard]] inline std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

/// Removes the first word of `text` and returns it; empty if there is none.
[[nodiscard]] inline std::string_view next_word(std::string_view* text) {
  const auto is_blank = [](char c) { return c == ' ' || (c >= '\t' && c <= '\r'); };
  std::size_t begin = 0;
  while (begin < text->size() && is_blank((*text)[begin])) ++begin;
  std::size_t end = begin;
  while (end < text->size() && !is_blank((*text)[end])) ++end;
  const std::string_view word = text->substr(begin, end - begin);
  text->remove_prefix(end);
  return word;
}

/// Parses the number at the beginning of `word`, independent of the locale; empty if there is none. Sets `*ret_whole`
/// (may be null) to true if the number fills the word. Numbers beyond the range of double become infinite or 0;
/// "1.#QNAN" and similar texts, as printed by Microsoft's libraries, become NaN.
[[nodiscard]] std::optional<double> number_in(std::string_view word, bool* ret_whole);

}  // namespace cyclorama

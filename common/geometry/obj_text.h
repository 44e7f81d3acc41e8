// SPDX-License-Identifier: Apache-2.0
/// Text of OBJ and MTL files, as written by any program.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "common/base/result.h"
#include "common/base/text_lines.h"

namespace cyclorama {

/// Returns UTF-8 without its byte order mark, as a view into `bytes`. UTF-16 with a byte order mark is converted into
/// `*storage`, into which the view then points.
[[nodiscard]] std::string_view to_utf8(std::span<const std::byte> bytes, std::string* storage);

/// Statements of an OBJ or MTL file: lines without comments, with lines that end in "\" joined to the next. Views are
/// valid until the next call. Thread-bound; borrows the text.
class ObjStatements {
 public:
  explicit ObjStatements(std::string_view text) : lines_(text) {}
  /// Sets the next statement, split after its keyword; empty lines are skipped. Returns false after the last one.
  bool next(std::string_view* ret_keyword, std::string_view* ret_rest);
  /// Number of the statement's last line, counted from 1.
  [[nodiscard]] std::size_t line() const { return line_; }

 private:
  LineReader lines_;
  std::size_t line_ = 0;
  std::string joined_;
};

/// The words of a face's corner "7/-1/3"; omitted ones are empty. `beyond` is surplus text.
struct ObjCornerWords {
  std::string_view vertex;
  std::string_view texture;
  std::string_view normal;
  std::string_view beyond;
};
[[nodiscard]] ObjCornerWords obj_corner(std::string_view word);

/// Converts a 1-based index, or a negative one that counts back from the last of the `so_far` elements above, to a
/// 0-based index. Empty if the word is not a number or refers to none of the `in_all` elements.
[[nodiscard]] std::optional<std::uint32_t> obj_index(std::string_view word, std::size_t so_far, std::size_t in_all);

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
/// The text of OBJ and MTL files, whatever program wrote it.
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

/// UTF-8 as it is, without its byte order mark: a view into `bytes`. UTF-16 with a byte order mark is converted into
/// `*storage`, and the view is into that.
[[nodiscard]] std::string_view to_utf8(std::span<const std::byte> bytes, std::string* storage);

/// Statements of an OBJ or MTL file: lines without comments, with lines that end in "\" joined to the next. The view is
/// good until the next call. Thread-bound; borrows the text.
class ObjStatements {
 public:
  explicit ObjStatements(std::string_view text) : lines_(text) {}
  /// Takes the keyword off the statement; empty lines are passed over. False after the last.
  bool next(std::string_view* ret_keyword, std::string_view* ret_rest);
  /// Of the statement's last line, from 1.
  [[nodiscard]] std::size_t line() const { return line_; }

 private:
  LineReader lines_;
  std::size_t line_ = 0;
  std::string joined_;
};

/// The words of a face's corner "7/-1/3", each empty where it is left out; `beyond` is what should not be there.
struct ObjCornerWords {
  std::string_view vertex;
  std::string_view texture;
  std::string_view normal;
  std::string_view beyond;
};
[[nodiscard]] ObjCornerWords obj_corner(std::string_view word);

/// Where in a list an index points: from 1, or back from the last of the `so_far` that stand above. Nothing where it is
/// no number or points at none of the `in_all`.
[[nodiscard]] std::optional<std::uint32_t> obj_index(std::string_view word, std::size_t so_far, std::size_t in_all);

}  // namespace cyclorama

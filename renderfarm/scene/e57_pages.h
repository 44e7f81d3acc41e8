// SPDX-License-Identifier: Apache-2.0
/// The pages of an E57 file; each ends with a checksum, which is not part of the content. Source: ASTM E2807, clause 7.
///
/// This reader exists because Debian has no E57 library, and the part of the format that points need is small.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::scene {

/// The content of an E57 file without its checksums. Borrows the file. Thread-safe.
class E57Pages {
 public:
  /// Opens a file. Errors: kBadData if `file` is not an E57 file or is shorter than its header states.
  static Result<E57Pages> open(std::span<const std::byte> file);

  /// Returns `size` bytes of the content from `offset` on. Errors: kBadData if the file ends before the last of them,
  /// or if the checksum of a page is wrong.
  Result<std::vector<std::byte>> read(std::uint64_t offset, std::uint64_t size) const;
  /// Returns the offset in the content of an offset in the file.
  [[nodiscard]] std::uint64_t content_offset(std::uint64_t file_offset) const;
  [[nodiscard]] std::uint64_t content_bytes() const;
  [[nodiscard]] std::uint64_t xml_offset() const { return xml_offset_; }  ///< Offset in the content.
  [[nodiscard]] std::uint64_t xml_bytes() const { return xml_bytes_; }

 private:
  [[nodiscard]] Status check_page(std::uint64_t page) const;

  std::span<const std::byte> file_;
  std::uint64_t page_bytes_ = 0;  ///< Includes the checksum.
  std::uint64_t xml_offset_ = 0;
  std::uint64_t xml_bytes_ = 0;
};

}  // namespace cyclorama::scene

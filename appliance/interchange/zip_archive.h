// SPDX-License-Identifier: Apache-2.0
/// Zip archives in memory, read as untrusted input and written reproducibly.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"

struct zip;

namespace cyclorama::interchange {

struct ZipMember {
  std::string name;
  std::vector<std::byte> bytes;
};

/// Reads the members of an archive, whose bytes it borrows. Thread-bound.
class ZipReader {
 public:
  /// Opens an archive. Refuses absolute names, names with "..", backslashes or control characters, duplicate names
  /// (compared without case), links, encryption, more than 1024 members, and members whose declared size is larger than
  /// deflate can produce. Errors: kBadData with the member and the remedy.
  static Result<ZipReader> open(std::span<const std::byte> archive, std::size_t limit_bytes);

  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// Unpacks a member and verifies its checksum. All members that a reader unpacks together have at most the
  /// `limit_bytes` of open(). Errors: kBadData if there is no such member, or it is damaged or too large.
  Result<std::vector<std::byte>> read(const std::string& name);

 private:
  struct Discard {
    void operator()(zip* archive) const;
  };
  std::unique_ptr<zip, Discard> archive_;
  std::vector<std::string> names_;
  std::size_t left_bytes_ = 0;
};

/// Packs members with deflate, in their order and without times, so that equal members give equal bytes.
Result<std::vector<std::byte>> write_zip(std::span<const ZipMember> members);

}  // namespace cyclorama::interchange

// SPDX-License-Identifier: Apache-2.0
/// Zip archives in memory, read with suspicion and written the same every time.
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

/// Thread-bound. Borrows the archive's bytes for its life.
class ZipReader {
 public:
  /// Refused: absolute names, names with "..", backslashes or control characters, names that are there twice (in
  /// whatever case), links, encryption, more than 1024 members, and members that claim to grow further than deflate
  /// can. kBadData  names the member and the remedy.
  static Result<ZipReader> open(std::span<const std::byte> archive, std::size_t limit_bytes);

  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// Unpacked and its checksum compared. All that one reader unpacks together keeps to the limit of open().
  /// kBadData  no such member, damaged, or too large.
  Result<std::vector<std::byte>> read(const std::string& name);

 private:
  struct Discard {
    void operator()(zip* archive) const;
  };
  std::unique_ptr<zip, Discard> archive_;
  std::vector<std::string> names_;
  std::size_t left_bytes_ = 0;
};

/// Deflated, in this order, without times: the same members give the same bytes.
Result<std::vector<std::byte>> write_zip(std::span<const ZipMember> members);

}  // namespace cyclorama::interchange

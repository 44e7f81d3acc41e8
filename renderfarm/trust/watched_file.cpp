// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/trust/watched_file.h"

#include "common/base/file.h"

namespace cyclorama::trust {
namespace {

constexpr std::size_t kMaxBytes = 4 << 20;

bool is_same(const timespec& a, const timespec& b) { return a.tv_sec == b.tv_sec && a.tv_nsec == b.tv_nsec; }

bool is_same(const struct ::stat& a, const struct ::stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino && a.st_size == b.st_size && is_same(a.st_mtim, b.st_mtim) &&
         is_same(a.st_ctim, b.st_ctim);
}

}  // namespace

std::optional<Result<std::string>> WatchedFile::changed() {
  struct ::stat now {};
  std::optional<struct ::stat> seen;
  if (::stat(path_.c_str(), &now) == 0) seen = now;
  const bool same = seen.has_value() == seen_.has_value() && (!seen || is_same(*seen, *seen_));
  if (asked_ && same) return std::nullopt;
  asked_ = true;
  seen_ = seen;
  return read_text_file(path_, kMaxBytes);
}

}  // namespace cyclorama::trust

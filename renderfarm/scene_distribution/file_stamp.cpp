// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene_distribution/file_stamp.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <cerrno>
#include <vector>

#include "renderfarm/scene_distribution/sha256.h"

namespace cyclorama::scene_distribution {
namespace {

std::int64_t nanoseconds_of(const timespec& time) {
  return static_cast<std::int64_t>(time.tv_sec) * 1'000'000'000 + time.tv_nsec;
}

Result<FileStamp> stamp_of(int fd, const std::filesystem::path& path) {
  struct stat info {};
  if (::fstat(fd, &info) != 0) return Error::from_errno(fmt::format("reading '{}'", path.string()));
  if (!S_ISREG(info.st_mode)) {
    return Error(ErrorCode::kBadData, fmt::format("'{}' is not a regular file", path.string()));
  }
  return FileStamp{info.st_ino, static_cast<std::uint64_t>(info.st_size), nanoseconds_of(info.st_mtim),
                   nanoseconds_of(info.st_ctim)};
}

}  // namespace

Result<StampedFile> open_stamped(const std::filesystem::path& path) {
  // O_NONBLOCK: a named pipe in place of the file must not block. It has no effect on regular files.
  UniqueFd fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!fd.is_open()) return Error::from_errno(fmt::format("opening '{}'", path.string()));
  TRY_ASSIGN(const FileStamp stamp, stamp_of(fd.get(), path));
  return StampedFile{std::move(fd), stamp};
}

Result<HashedFile> hash_file(const std::filesystem::path& path, const ContinueCheck& should_continue) {
  TRY_ASSIGN(const StampedFile file, open_stamped(path));
  Sha256 sum;
  std::vector<std::byte> piece(std::size_t{1} << 20);
  std::uint64_t done = 0;
  for (;;) {
    const ssize_t n = ::read(file.fd.get(), piece.data(), piece.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return Error::from_errno(fmt::format("reading '{}'", path.string()));
    if (n == 0) break;
    sum.add(std::span(piece).first(static_cast<std::size_t>(n)));
    done += static_cast<std::uint64_t>(n);
    if (!should_continue(static_cast<std::uint64_t>(n))) return Error(ErrorCode::kUnavailable, "given up");
  }
  TRY_ASSIGN(const FileStamp after, stamp_of(file.fd.get(), path));
  if (after != file.stamp || done != after.bytes) {
    return Error(ErrorCode::kBusy, fmt::format("'{}' was changed while it was read", path.string()));
  }
  return HashedFile{after, sum.hexadecimal()};
}

}  // namespace cyclorama::scene_distribution

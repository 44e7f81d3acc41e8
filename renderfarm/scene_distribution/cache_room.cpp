// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene_distribution/cache_room.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <algorithm>
#include <system_error>
#include <vector>

#include "common/base/unique_fd.h"
#include "renderfarm/scene_distribution/sha256.h"

namespace cyclorama::scene_distribution {
namespace {

namespace fs = std::filesystem;

struct Entry {
  fs::path path;
  std::uint64_t bytes = 0;
  std::uint64_t links = 0;
  fs::file_time_type time{};
};

std::vector<Entry> entries_of(const fs::path& folder) {
  std::vector<Entry> entries;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    struct stat info {};
    if (::lstat(at->path().c_str(), &info) != 0) continue;
    std::error_code ignored;
    entries.push_back({at->path(), static_cast<std::uint64_t>(info.st_size), info.st_nlink,
                       fs::last_write_time(at->path(), ignored)});
  }
  std::ranges::sort(entries, {}, &Entry::time);
  return entries;
}

/// Returns the digest in the name of a complete or partial file; empty for other names.
std::string sha256_in(const fs::path& path) {
  const std::string stem = path.stem().string();
  const std::string extension = path.extension().string();
  return is_sha256(stem) && (extension.empty() || extension == ".part") ? stem : "";
}

class Room {
 public:
  Room(const fs::path& cache, std::uint64_t limit_bytes, const CacheNeeds& needs)
      : cache_(cache), limit_bytes_(limit_bytes), needs_(needs) {}

  /// Drops files that belong to no scene until there is room.
  Status drop_loose_files(bool* ret_fits) {
    const std::vector<Entry> entries = entries_of(cache_ / "files");
    std::uint64_t used = 0;
    for (const Entry& entry : entries) {
      if (!sha256_in(entry.path).empty()) used += entry.bytes;
    }
    for (const Entry& entry : entries) {
      TRY_ASSIGN(*ret_fits, fits(used));
      if (*ret_fits) return Done{};
      const std::string sha256 = sha256_in(entry.path);
      if (sha256.empty() || entry.links > 1 || needs_.sha256.contains(sha256)) continue;
      if (::unlink(entry.path.c_str()) == 0) used -= entry.bytes;
    }
    TRY_ASSIGN(*ret_fits, fits(used));
    return Done{};
  }

  /// Drops the least recently requested scene that may be dropped. Returns false if there is none.
  bool drop_oldest_scene() {
    for (const Entry& entry : entries_of(cache_ / "scenes")) {
      if (!is_sha256(entry.path.filename().string()) || entry.path.filename() == needs_.digest) continue;
      const UniqueFd folder(::open(entry.path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
      if (!folder.is_open() || ::flock(folder.get(), LOCK_EX | LOCK_NB) != 0) continue;
      drop_folder(entry.path);
      std::error_code ignored;
      if (!fs::exists(entry.path, ignored)) return true;
    }
    return false;
  }

 private:
  Result<bool> fits(std::uint64_t used) const {
    std::error_code error;
    const fs::space_info space = fs::space(cache_, error);
    if (error) {
      return Error(ErrorCode::kSystem, fmt::format("the cache '{}': {}", cache_.string(), error.message()));
    }
    return needs_.bytes <= space.available && (limit_bytes_ == 0 || used + needs_.bytes <= limit_bytes_);
  }

  const fs::path& cache_;
  const std::uint64_t limit_bytes_;
  const CacheNeeds& needs_;
};

double gib(std::uint64_t bytes) { return static_cast<double>(bytes) / (1 << 30); }

}  // namespace

void drop_folder(const fs::path& folder) {
  fs::path doomed = folder;
  doomed += ".old";
  std::error_code ignored;
  fs::remove_all(doomed, ignored);
  fs::rename(folder, doomed, ignored);
  fs::remove_all(doomed, ignored);
}

Status make_room(const fs::path& cache, std::uint64_t limit_bytes, const CacheNeeds& needs) {
  Room room(cache, limit_bytes, needs);
  for (;;) {
    bool has_room = false;
    TRY(room.drop_loose_files(&has_room));
    if (has_room) return Done{};
    if (!room.drop_oldest_scene()) break;
  }
  const std::string limit =
      limit_bytes > 0 ? fmt::format(" or may have no more than {:.3g} GiB", gib(limit_bytes)) : "";
  return Error(ErrorCode::kSystem,
               fmt::format("the scene needs {:.3g} GiB more, but the disk of the cache '{}' is full{}; free some of "
                           "it, raise cache_gib, or give 'cache' another place",
                           gib(needs.bytes), cache.string(), limit));
}

}  // namespace cyclorama::scene_distribution

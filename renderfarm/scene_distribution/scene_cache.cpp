// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene_distribution/scene_cache.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <optional>
#include <system_error>
#include <thread>
#include <vector>

#include "common/base/clock.h"
#include "renderfarm/scene_distribution/cache_room.h"
#include "renderfarm/scene_distribution/sha256.h"

namespace cyclorama::scene_distribution {
namespace {

namespace fs = std::filesystem;

Error given_up() { return Error(ErrorCode::kUnavailable, "given up"); }

Status make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error) return Done{};
  return Error(ErrorCode::kSystem, fmt::format("making the folder '{}': {}; give 'cache' a place that this user may "
                                               "write to",
                                               folder.string(), error.message()));
}

/// Makes the names in a folder durable.
Status sync_folder(const fs::path& folder) {
  const UniqueFd fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!fd.is_open() || ::fsync(fd.get()) != 0) {
    return Error::from_errno(fmt::format("writing the folder '{}'", folder.string()));
  }
  return Done{};
}

Status write_at(int fd, std::uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::pwrite(fd, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return Error::from_errno("writing");
    bytes = bytes.subspan(static_cast<std::size_t>(n));
    offset += static_cast<std::uint64_t>(n);
  }
  return Done{};
}

}  // namespace

/// Progress of one scene, in bytes that are checked or fetched.
struct SceneCache::Count {
  const CacheProgress& progress;
  std::uint64_t all;
  std::uint64_t done = 0;
  std::uint64_t fetched = 0;

  bool add(const char* doing, std::uint64_t bytes) {
    done += bytes;
    return report_progress(doing);
  }
  [[nodiscard]] bool report_progress(const char* doing) const {
    return progress(doing, all == 0 ? 1.0 : std::min(1.0, static_cast<double>(done) / static_cast<double>(all)));
  }
};

SceneCache::SceneCache(SceneCacheOptions options) : options_(std::move(options)) {}

Result<SceneCache> SceneCache::open(SceneCacheOptions options) {
  SceneCache cache(std::move(options));
  TRY(make_folder(cache.options_.folder / "files"));
  TRY(make_folder(cache.options_.folder / "scenes"));
  cache.sweep();
  return cache;
}

fs::path SceneCache::file(const std::string& sha256) const { return options_.folder / "files" / sha256; }
fs::path SceneCache::part(const std::string& sha256) const { return options_.folder / "files" / (sha256 + ".part"); }

Result<UniqueFd> SceneCache::lock(const CacheProgress& progress) const {
  const fs::path path = options_.folder / "lock";
  UniqueFd fd(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (!fd.is_open()) {
    return Error::from_errno(fmt::format("opening '{}'", path.string()));
  }
  while (::flock(fd.get(), LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK && errno != EINTR) return Error::from_errno(fmt::format("locking '{}'", path.string()));
    if (!progress("waiting for another node to fill the cache", 0.0)) return given_up();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));  // flock(2) has no deadline.
  }
  return fd;
}

void SceneCache::sweep() const {
  const auto held = lock([](const char*, double) { return false; });
  if (!held) return;  // Leftovers may belong to another node that is filling the cache.
  std::vector<fs::path> left_over;
  std::error_code error;
  for (fs::directory_iterator at(options_.folder / "scenes", error), end; !error && at != end; at.increment(error)) {
    if (!is_sha256(at->path().filename().string())) left_over.push_back(at->path());
  }
  for (const fs::path& path : left_over) fs::remove_all(path, error);
}

Error SceneCache::write_error(const SceneFile& file, const Error& reason) const {
  const std::string doing = fmt::format("writing '{}' to the cache '{}'", file.path, options_.folder.string());
  const int number = reason.errno_value();
  if (number != ENOSPC && number != EDQUOT && number != EFBIG) return Error(reason).while_doing(doing);
  return Error(ErrorCode::kSystem, doing + ": its disk is full; free some of it, or give 'cache' another place");
}

Result<SceneCache::Held> SceneCache::bring(const SceneFiles& files, FileSource& source, const CacheProgress& progress) {
  Held scene;
  TRY_ASSIGN(const UniqueFd lock_held, lock(progress));
  std::vector<SceneFile> missing;
  CacheNeeds needs;
  needs.digest = digest_of(files);
  Count count{progress, bytes_of(files)};
  for (const SceneFile& wanted : files) {
    if (!needs.sha256.insert(wanted.sha256).second) {
      count.done += wanted.bytes;  // Another file has the same bytes.
      continue;
    }
    TRY_ASSIGN(const bool is_there, has(wanted, count));
    if (is_there) continue;
    missing.push_back(wanted);
    needs.bytes += wanted.bytes;
    std::error_code none;
    const std::uint64_t cached = fs::file_size(part(wanted.sha256), none);
    if (!none && cached <= wanted.bytes) needs.bytes -= cached;
  }
  TRY(make_room(options_.folder, options_.limit_bytes, needs));
  for (const SceneFile& wanted : missing) {
    TRY(fetch(wanted, source, count));
  }
  scene.path = options_.folder / "scenes" / needs.digest;
  if (!is_linked(files, scene.path)) TRY(link_scene(files, scene.path));
  for (const auto& sha256 : needs.sha256) {
    TRY_ASSIGN(const StampedFile linked, open_stamped(file(sha256)));
    verified_[sha256] = linked.stamp;  // Adding a link to a file changes the file's stamp.
  }
  scene.hold = UniqueFd(::open(scene.path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!scene.hold.is_open() || ::flock(scene.hold.get(), LOCK_SH) != 0 || ::futimens(scene.hold.get(), nullptr) != 0) {
    return Error::from_errno(fmt::format("opening '{}'", scene.path.string()));
  }
  if (files.size() == 1 && files.front().path != "scene.toml") scene.path /= files.front().path;
  scene.fetched_bytes = count.fetched;
  return scene;
}

Result<bool> SceneCache::has(const SceneFile& wanted, Count& count) {
  const fs::path path = file(wanted.sha256);
  std::error_code none;
  if (!fs::exists(fs::symlink_status(path, none))) return false;
  const auto here = open_stamped(path);
  const auto known = verified_.find(wanted.sha256);
  if (here && known != verified_.end() && known->second == here->stamp) {
    if (!count.add("checking", wanted.bytes)) return given_up();
    return true;
  }
  const std::uint64_t before = count.done;
  if (here && here->stamp.bytes == wanted.bytes) {
    const auto hashed = hash_file(path, [&](std::uint64_t bytes) { return count.add("checking", bytes); });
    if (hashed && hashed->sha256 == wanted.sha256) {
      verified_[wanted.sha256] = hashed->stamp;
      return true;
    }
    if (!hashed && hashed.error().code() == ErrorCode::kUnavailable) return hashed.error();
  }
  count.done = before;
  fs::remove_all(path, none);  // The file is damaged or unreadable.
  return false;
}

Status SceneCache::fetch(const SceneFile& wanted, FileSource& source, Count& count) {
  const fs::path path = part(wanted.sha256);
  const UniqueFd fd(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (!fd.is_open()) return write_error(wanted, Error::from_errno("making its part"));
  for (;;) {
    struct stat info {};
    if (::fstat(fd.get(), &info) != 0) return Error::from_errno(fmt::format("reading '{}'", path.string()));
    const auto have = static_cast<std::uint64_t>(info.st_size);
    std::string sha256;
    const std::uint64_t before = count.done;
    if (have <= wanted.bytes) TRY(append(wanted, fd.get(), have, source, count, &sha256));
    if (sha256 == wanted.sha256) break;
    count.done = before;
    if (::ftruncate(fd.get(), 0) != 0) return Error::from_errno(fmt::format("emptying '{}'", path.string()));
    // A crash may have damaged the part received earlier: try once more from the beginning.
    if (have == 0) {
      return Error(ErrorCode::kBadData,
                   fmt::format("the coordinator sent bytes for '{}' that do not match its list; if the "
                               "file was changed there, restart the coordinator",
                               wanted.path));
    }
  }
  if (::fchmod(fd.get(), 0400) != 0 || ::fsync(fd.get()) != 0 ||
      ::rename(path.c_str(), file(wanted.sha256).c_str()) != 0) {
    return write_error(wanted, Error::from_errno("finishing it"));
  }
  return sync_folder(options_.folder / "files");
}

Status SceneCache::append(const SceneFile& wanted, int fd, std::uint64_t have, FileSource& source, Count& count,
                          std::string* ret_sha256) const {
  Sha256 sum;
  std::vector<std::byte> piece(std::size_t{1} << 20);
  for (std::uint64_t done = 0; done < have;) {
    const auto want = static_cast<std::size_t>(std::min<std::uint64_t>(piece.size(), have - done));
    const ssize_t n = ::pread(fd, piece.data(), want, static_cast<off_t>(done));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return Error::from_errno(fmt::format("reading the received part of '{}'", wanted.path));
    sum.add(std::span(piece).first(static_cast<std::size_t>(n)));
    done += static_cast<std::uint64_t>(n);
    if (!count.add("checking", static_cast<std::uint64_t>(n))) return given_up();
  }
  if (!count.report_progress("fetching")) return given_up();
  std::optional<Error> mine;  // An error of this function, as opposed to one of the source.
  const auto sink = [&](std::span<const std::byte> bytes) -> Status {
    if (bytes.size() > wanted.bytes - have) {
      mine = Error(ErrorCode::kBadData,
                   fmt::format("the coordinator sent more of '{}' than its list states", wanted.path));
    } else if (const Status written = write_at(fd, have, bytes); !written) {
      mine = write_error(wanted, written.error());
    } else {
      sum.add(bytes);
      have += bytes.size();
      count.fetched += bytes.size();
      if (!count.add("fetching", bytes.size())) mine = given_up();
    }
    if (mine) return *mine;
    return Done{};
  };
  if (have < wanted.bytes) {
    const Status read = source.read(wanted.sha256, have, sink);
    if (mine) return *mine;
    if (!read) return Error(read.error()).while_doing(fmt::format("fetching '{}'", wanted.path));
  }
  if (have < wanted.bytes) {
    return Error(ErrorCode::kBadData,
                 fmt::format("the coordinator sent less of '{}' than its list states", wanted.path));
  }
  *ret_sha256 = sum.hexadecimal();
  return Done{};
}

bool SceneCache::is_linked(const SceneFiles& files, const fs::path& folder) const {
  std::error_code error;
  std::size_t found = 0;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    if (!at->is_directory(error)) ++found;
  }
  if (error || found != files.size()) return false;
  return std::ranges::all_of(files, [&](const SceneFile& wanted) {
    std::error_code none;
    return fs::equivalent(folder / wanted.path, file(wanted.sha256), none);
  });
}

Status SceneCache::link_scene(const SceneFiles& files, const fs::path& folder) const {
  fs::path made = folder;
  made += ".new";
  std::error_code error;
  fs::remove_all(made, error);
  for (const SceneFile& wanted : files) {
    const fs::path to = made / wanted.path;
    TRY(make_folder(to.parent_path()));
    fs::create_hard_link(file(wanted.sha256), to, error);
    if (error) {
      return Error(ErrorCode::kSystem,
                   fmt::format("linking '{}': {}; 'cache' must be on a file system with hard links, such as ext4",
                               to.string(), error.message()));
    }
  }
  drop_folder(folder);
  fs::rename(made, folder, error);
  if (error) return Error(ErrorCode::kSystem, fmt::format("making '{}': {}", folder.string(), error.message()));
  return Done{};
}

}  // namespace cyclorama::scene_distribution

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>

#include "common/base/result.h"
#include "common/base/unique_fd.h"
#include "renderfarm/scene_distribution/file_stamp.h"
#include "renderfarm/scene_distribution/scene_files.h"

namespace cyclorama::scene_distribution {

/// A source of files that a cache lacks.
class FileSource {
 public:
  using Sink = std::function<Status(std::span<const std::byte>)>;
  virtual ~FileSource() = default;
  /// Passes the file's bytes from `offset` on to `sink`, in order and in pieces of any size. Errors: those of `sink`,
  /// and those of the source.
  virtual Status read(const std::string& sha256, std::uint64_t offset, const Sink& sink) = 0;

 protected:
  FileSource() = default;
  FileSource(const FileSource&) = default;
  FileSource& operator=(const FileSource&) = default;
};

struct SceneCacheOptions {
  std::filesystem::path folder;   ///< Created if absent. Must be on a file system with hard links.
  std::uint64_t limit_bytes = 0;  ///< Limit for all files; 0: only the disk limits them.
};

/// Receives the current step ("checking", "fetching", "waiting for another node to fill the cache") and the completed
/// fraction of the scene's bytes. Returns false to give up.
using CacheProgress = std::function<bool(const char* doing, double fraction)>;

/// A node's scenes on its own disk. Each file is stored once, under its SHA-256.
///
///   files/<sha256>       a complete and verified file
///   files/<sha256>.part  the bytes received so far; the next attempt continues at their end
///   scenes/<digest>/     the paths of a scene: hard links to its files; the folder's time is that of the last request
///
/// The bytes of every file of a scene are verified before the scene is returned; a damaged file is fetched again. A
/// file that this object has verified and whose stamp is unchanged is not read again. A crash or a power cut at any
/// moment costs at most the bytes that were not yet written. To make room, files that belong to no scene are dropped
/// first, then the least recently requested scenes. Several processes may share a folder; one at a time fills it.
/// Thread-bound.
class SceneCache {
 public:
  /// Opens a cache: creates the folders and removes leftovers of a crash. Errors: kSystem if they cannot be created or
  /// written.
  static Result<SceneCache> open(SceneCacheOptions options);

  /// A complete scene, which is kept in the cache while this object exists.
  struct Held {
    std::filesystem::path path;  ///< Argument for load_scene(): the folder, or the only file of the scene.
    std::uint64_t fetched_bytes = 0;
    UniqueFd hold;  ///< Shared flock(2) on the folder, which prevents its removal.
  };
  /// Provides the scene's files; missing files are fetched from `source`. Precondition: validate(files) succeeds.
  /// Blocks.
  ///
  /// Errors, in addition to those of `source`:
  /// kBadData      the source's bytes do not match the list.
  /// kBusy         a file in the cache was changed meanwhile.
  /// kUnavailable  `progress` returned false.
  /// kSystem       the scene exceeds the cache's limit, or the disk is full or fails: one sentence with a remedy.
  Result<Held> bring(const SceneFiles& files, FileSource& source, const CacheProgress& progress);

 private:
  explicit SceneCache(SceneCacheOptions options);

  struct Count;
  Result<UniqueFd> lock(const CacheProgress& progress) const;
  void sweep() const;
  /// Returns true if the file is present and intact. Removes a damaged file.
  Result<bool> has(const SceneFile& file, Count& count);
  Status fetch(const SceneFile& file, FileSource& source, Count& count);
  Status append(const SceneFile& file, int fd, std::uint64_t have, FileSource& source, Count& count,
                std::string* ret_sha256) const;
  Status link_scene(const SceneFiles& files, const std::filesystem::path& folder) const;
  [[nodiscard]] bool is_linked(const SceneFiles& files, const std::filesystem::path& folder) const;
  [[nodiscard]] std::filesystem::path file(const std::string& sha256) const;
  [[nodiscard]] std::filesystem::path part(const std::string& sha256) const;
  [[nodiscard]] Error write_error(const SceneFile& file, const Error& reason) const;

  SceneCacheOptions options_;
  std::map<std::string, FileStamp> verified_;  ///< Keyed by SHA-256.
};

}  // namespace cyclorama::scene_distribution

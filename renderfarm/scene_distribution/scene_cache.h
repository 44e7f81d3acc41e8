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

/// Source of the files that a cache lacks.
class FileSource {
 public:
  using Sink = std::function<Status(std::span<const std::byte>)>;
  virtual ~FileSource() = default;
  /// Passes the file's bytes from `offset` on to `sink`, in order and in pieces of any size; returns an error of
  /// `sink`.
  virtual Status read(const std::string& sha256, std::uint64_t offset, const Sink& sink) = 0;

 protected:
  FileSource() = default;
  FileSource(const FileSource&) = default;
  FileSource& operator=(const FileSource&) = default;
};

struct SceneCacheOptions {
  std::filesystem::path folder;   ///< Created if absent; must be on a file system with hard links.
  std::uint64_t limit_bytes = 0;  ///< Limit for all files; 0 leaves only that of the disk.
};

/// Receives the current step ("checking", "fetching", "waiting for another node to fill the cache") and the fraction of
/// the scene's bytes that is done. Returns false to give up.
using CacheProgress = std::function<bool(const char* doing, double fraction)>;

/// A node's scenes on its own disk; each file is stored once, by its SHA-256.
///
///   files/<sha256>       complete and verified; gets this name only then
///   files/<sha256>.part  received so far; the next attempt continues at its end
///   scenes/<digest>/     the scene's paths: hard links to the files; its time is when the scene was last requested
///
/// Every file of a scene is verified by its bytes before the scene is returned, and fetched again if it is damaged. A
/// file that this object has verified and whose stamp is unchanged is not read again. So a crash or a power cut at any
/// moment costs at most what was not yet written. Room is made by dropping files that belong to no scene, then the
/// least recently requested scenes. Several processes may share a folder: one fills it at a time. Thread-bound.
class SceneCache {
 public:
  /// Creates the folders and removes leftovers of a crash. Errors: kSystem if they cannot be created or written.
  static Result<SceneCache> open(SceneCacheOptions options);

  /// A complete scene, kept while this object lives.
  struct Held {
    std::filesystem::path path;  ///< Argument for load_scene(): the folder, or the scene's only file.
    std::uint64_t fetched_bytes = 0;
    UniqueFd hold;  ///< A shared flock(2) on the folder, which prevents dropping it.
  };
  /// Provides the scene's files, fetching missing ones from `source`. Precondition: validate(files). Blocks.
  ///
  /// Errors, besides those of `source`:
  /// kBadData      the source's bytes do not match the list.
  /// kBusy         a file in the cache was changed meanwhile.
  /// kUnavailable  given up.
  /// kSystem       the scene exceeds the cache's limit, or the disk is full or fails: one sentence with a remedy.
  Result<Held> bring(const SceneFiles& files, FileSource& source, const CacheProgress& progress);

 private:
  explicit SceneCache(SceneCacheOptions options);

  struct Count;
  Result<UniqueFd> lock(const CacheProgress& progress) const;
  void sweep() const;
  /// Returns true if the file is present and intact; removes a damaged one.
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

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

namespace cyclorama {

/// Where a cache gets what it lacks.
class FileSource {
 public:
  using Sink = std::function<Status(std::span<const std::byte>)>;
  virtual ~FileSource() = default;
  /// Gives the file's bytes from `offset` on to `sink`, in order and in pieces of any size; ends with what `sink`
  /// failed with.
  virtual Status read(const std::string& sha256, std::uint64_t offset, const Sink& sink) = 0;

 protected:
  FileSource() = default;
  FileSource(const FileSource&) = default;
  FileSource& operator=(const FileSource&) = default;
};

struct SceneCacheOptions {
  std::filesystem::path folder;   ///< Made if it is absent; on a file system with hard links.
  std::uint64_t limit_bytes = 0;  ///< Of all files; 0: what the disk has room for.
};

/// Told what goes on ("checking", "fetching", "waiting for another node to fill the cache") and which fraction of the
/// scene's bytes is done. False: give up.
using CacheProgress = std::function<bool(const char* doing, double fraction)>;

/// A node's scenes on its own disk, each file once, by its SHA-256.
///
///   files/<sha256>       whole and verified: it gets this name only then
///   files/<sha256>.part  as much as came; the next attempt goes on at its end
///   scenes/<digest>/     the scene's paths: hard links to the files; its time is when the scene was last wanted
///
/// Every file of a scene is verified by its bytes before the scene is given out, and fetched anew when it is damaged;
/// what this object has verified, and whose stamp is still the same, is not read again. So a crash or a power cut at
/// any moment costs at most what was not yet written. Room is made by dropping what belongs to no scene, then the
/// scenes that were not wanted for longest. Several processes may share a folder: one fills it at a time. Thread-bound.
class SceneCache {
 public:
  /// Makes the folders, and sweeps what a crash left. kSystem  they cannot be made or written.
  static Result<SceneCache> open(SceneCacheOptions options);

  /// A scene that is there, and stays while this lives.
  struct Held {
    std::filesystem::path path;  ///< What load_scene() takes: the folder, or the scene's only file.
    std::uint64_t fetched_bytes = 0;
    UniqueFd hold;  ///< A shared flock(2) on the folder: nobody drops it.
  };
  /// Brings the scene's files, the missing ones from `source`. Precondition: validate(files). Blocks.
  ///
  /// kBadData      the source's bytes are not what the list says.
  /// kBusy         a file was changed in the cache meanwhile.     kUnavailable  given up.
  /// kSystem       the scene is larger than the cache may be, the disk is full or fails: one sentence with a remedy.
  /// Else what the source said.
  Result<Held> bring(const SceneFiles& files, FileSource& source, const CacheProgress& progress);

 private:
  explicit SceneCache(SceneCacheOptions options);

  struct Count;
  Result<UniqueFd> lock(const CacheProgress& progress) const;
  void sweep() const;
  /// Whether the file is there with its bytes; one that is damaged is removed.
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
  std::map<std::string, FileStamp> verified_;  ///< By SHA-256.
};

}  // namespace cyclorama

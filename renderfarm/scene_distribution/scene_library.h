// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "renderfarm/scene_distribution/scene_listing.h"

namespace cyclorama::scene_distribution {

/// The scenes on this machine's disk that nodes may fetch, by digest. Reads each scene once, one after another, on the
/// thread `scenes`; retries unreadable scenes every few seconds. Does not notice later changes: a scene stays as it was
/// read, and a file that was changed since is refused. Thread-safe.
class SceneLibrary {
 public:
  struct Source {
    std::string name;
    std::filesystem::path path;  ///< Argument for list_scene().
  };
  struct News {
    std::string scene;
    std::string digest;    ///< Empty if it is not known yet.
    std::string sentence;  ///< For the log.
  };
  /// Starts reading. `on_news` is called on the thread `scenes`. `digests` is the file of DigestMemory, or empty.
  SceneLibrary(std::vector<Source> sources, std::filesystem::path digests, std::function<void(News)> on_news);
  ~SceneLibrary();
  SceneLibrary(const SceneLibrary&) = delete;
  SceneLibrary& operator=(const SceneLibrary&) = delete;

  /// Returns true until each scene was read or has failed. Until then, a missing digest may still be added.
  [[nodiscard]] bool is_reading() const { return is_reading_; }
  /// Returns null if no scene has this digest.
  [[nodiscard]] std::shared_ptr<const SceneFiles> find(const std::string& digest) const;
  /// Opens a file of some scene; no other file can be opened. Errors: kNotFound if no scene has it or it changed since
  /// it was read; kUnavailable if no scene has it while is_reading().
  [[nodiscard]] Result<StampedFile> open(const std::string& sha256) const;

 private:
  void run(const std::stop_token& stop, std::vector<Source> sources, const std::filesystem::path& digests);
  /// Reads a scene. If it cannot be read, the digest is empty and the sentence gives the reason.
  News read(const std::stop_token& stop, const Source& source, DigestMemory& memory);
  void add(SceneListing listing);

  const std::function<void(News)> on_news_;
  std::atomic<bool> is_reading_ = true;
  mutable std::mutex mutex_;  ///< Guards the following.
  std::condition_variable_any stopped_;
  std::map<std::string, std::shared_ptr<const SceneFiles>> scenes_;  ///< Keyed by digest.
  std::map<std::string, std::vector<SceneListing::Place>> places_;   ///< Keyed by SHA-256.
  std::jthread thread_;
};

}  // namespace cyclorama::scene_distribution

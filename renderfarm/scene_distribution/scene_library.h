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

namespace cyclorama {

/// The scenes on this machine's disk that others may have, by digest. Reads them once, in a thread of its own
/// (`scenes`), one after the other; one that cannot be read is tried again every few seconds. What changes afterwards
/// is not noticed: a scene is what it was when it was read, and a file that was changed since is refused. Thread-safe.
class SceneLibrary {
 public:
  struct Source {
    std::string name;
    std::filesystem::path path;  ///< As list_scene().
  };
  struct News {
    std::string scene;
    std::string digest;    ///< Empty: not known yet.
    std::string sentence;  ///< For the log.
  };
  /// Starts to read. `tell` is called on the thread; `digests` is DigestMemory's file, or empty.
  SceneLibrary(std::vector<Source> sources, std::filesystem::path digests, std::function<void(News)> tell);
  ~SceneLibrary();
  SceneLibrary(const SceneLibrary&) = delete;
  SceneLibrary& operator=(const SceneLibrary&) = delete;

  /// True until each scene was read, or could not be: what is not found may come yet.
  [[nodiscard]] bool is_reading() const { return is_reading_; }
  /// Null: no scene of that digest.
  [[nodiscard]] std::shared_ptr<const SceneFiles> find(const std::string& digest) const;
  /// A file of some scene, never any other. kNotFound  there is none, or it was changed since it was read.
  /// kUnavailable  there is none, while is_reading().
  [[nodiscard]] Result<StampedFile> open(const std::string& sha256) const;

 private:
  void run(const std::stop_token& stop, std::vector<Source> sources, const std::filesystem::path& digests);
  /// Without a digest if it could not be read, and why.
  News read(const std::stop_token& stop, const Source& source, DigestMemory& memory);
  void add(SceneListing listing);

  const std::function<void(News)> tell_;
  std::atomic<bool> is_reading_ = true;
  mutable std::mutex mutex_;  ///< Guards the following.
  std::condition_variable_any stopped_;
  std::map<std::string, std::shared_ptr<const SceneFiles>> scenes_;  ///< By digest.
  std::map<std::string, std::vector<SceneListing::Place>> places_;   ///< By SHA-256.
  std::jthread thread_;
};

}  // namespace cyclorama

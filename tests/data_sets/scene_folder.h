// SPDX-License-Identifier: Apache-2.0
/// Scenes for tests of file distribution, and temporary folders.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include "common/base/check.h"
#include "renderfarm/scene_distribution/scene_cache.h"
#include "renderfarm/scene_distribution/scene_files.h"
#include "renderfarm/scene_distribution/sha256.h"

namespace cyclorama {

/// Path and bytes of each of a scene's files.
using SceneBytes = std::map<std::string, std::string>;

inline scene_distribution::SceneFiles files_of(const SceneBytes& scene) {
  scene_distribution::SceneFiles files;
  for (const auto& [path, bytes] : scene) files.push_back({path, bytes.size(), scene_distribution::sha256_of(bytes)});
  return files;
}

/// Returns incompressible bytes; the same for the same seed.
inline std::string noise_bytes(std::size_t size, unsigned seed) {
  std::string bytes(size, '\0');
  std::uint32_t state = seed * 2654435761u + 1u;
  for (char& byte : bytes) {
    state = state * 1664525u + 1013904223u;
    byte = static_cast<char>(state >> 24);
  }
  return bytes;
}

inline std::string bytes_in(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write_bytes(const std::filesystem::path& file, const std::string& bytes) {
  std::filesystem::create_directories(file.parent_path());
  std::filesystem::remove(file);
  std::ofstream(file, std::ios::binary) << bytes;
}

/// Reads the contents of a folder.
inline SceneBytes scene_in(const std::filesystem::path& folder) {
  SceneBytes scene;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) {
      scene[entry.path().lexically_relative(folder).string()] = bytes_in(entry.path());
    }
  }
  return scene;
}

/// Delivers its content in small pieces, and counts requests.
class ScriptedSource final : public scene_distribution::FileSource {
 public:
  explicit ScriptedSource(const SceneBytes& scene) {
    for (const auto& [path, bytes] : scene) content[scene_distribution::sha256_of(bytes)] = bytes;
  }
  Status read(const std::string& sha256, std::uint64_t offset, const Sink& sink) override {
    ++reads;
    const std::string& bytes = content.at(sha256);
    for (std::size_t at = offset; at < bytes.size();) {
      if (fail_after == 0) return Error(ErrorCode::kUnavailable, "the line is broken");
      const std::size_t size = std::min({bytes.size() - at, piece, fail_after});
      if (Status fine = sink(std::as_bytes(std::span(bytes).subspan(at, size))); !fine) return fine;
      at += size;
      given += size;
      fail_after -= size;
    }
    return Done{};
  }

  std::map<std::string, std::string> content;  ///< Keyed by SHA-256, which a dishonest source does not match.
  std::size_t piece = 16;
  std::size_t fail_after = std::string::npos;  ///< Number of bytes until the connection breaks permanently.
  std::size_t given = 0;
  int reads = 0;
};

/// A folder that is initially empty and deleted at the end; in memory if possible, so that a sync is cheap.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::filesystem::path place = "/dev/shm";
    if (!std::filesystem::is_directory(place)) place = testing::TempDir();
    std::string name = place / "cyclorama-XXXXXX";
    const char* const made = ::mkdtemp(name.data());
    CHECK(made != nullptr);
    path_ = made;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace cyclorama

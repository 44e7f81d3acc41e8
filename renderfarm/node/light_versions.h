// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>

#include "common/wire/nodes.pb.h"
#include "renderfarm/light/light_store.h"

namespace cyclorama::node {

/// Light of a scene and the name of its version. A value; the light itself never changes.
struct VersionedLight {
  std::string version;  ///< Result of version_of() for its file.
  std::uint64_t file_bytes = 0;
  std::shared_ptr<const light::LightStore> store;
};

/// Returns the SHA-256 of a file of stored light. The file states everything that its light depends on, so the version
/// identifies that, too. Hosts that round differently produce different versions.
[[nodiscard]] std::string version_of(std::span<const std::byte> file);

[[nodiscard]] wire::LightVersion version_message(const VersionedLight& light);

/// The versions of one scene's light that pictures may name: the newest two, so that frames in flight and pictures at
/// rest keep their version when a new one arrives. Thread-safe.
class LightVersions {
 public:
  void add(VersionedLight light);
  /// Returns nothing if there is no such version.
  [[nodiscard]] std::optional<VersionedLight> find(const std::string& version) const;
  [[nodiscard]] std::optional<VersionedLight> newest() const;
  /// Returns the memory that all versions take.
  [[nodiscard]] std::size_t bytes() const;

 private:
  mutable std::mutex mutex_;  ///< Guards the following.
  std::deque<VersionedLight> newest_first_;
};

}  // namespace cyclorama::node

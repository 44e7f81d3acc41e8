// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/light_versions.h"

#include <algorithm>
#include <utility>

#include "common/wire/light_versions.h"
#include "renderfarm/scene_distribution/sha256.h"

namespace cyclorama::node {

std::string version_of(std::span<const std::byte> file) {
  scene_distribution::Sha256 sum;
  sum.add(file);
  return sum.hexadecimal();
}

wire::LightVersion version_message(const VersionedLight& light) {
  wire::LightVersion out;
  out.set_version(light.version);
  out.set_bytes(light.file_bytes);
  return out;
}

void LightVersions::add(VersionedLight light) {
  const std::lock_guard lock(mutex_);
  std::erase_if(newest_first_, [&](const VersionedLight& known) { return known.version == light.version; });
  newest_first_.push_front(std::move(light));
  if (newest_first_.size() > wire::kKeptLightVersions) newest_first_.pop_back();
}

std::optional<VersionedLight> LightVersions::find(const std::string& version) const {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find(newest_first_, version, &VersionedLight::version);
  if (found == newest_first_.end()) return std::nullopt;
  return *found;
}

std::optional<VersionedLight> LightVersions::newest() const {
  const std::lock_guard lock(mutex_);
  if (newest_first_.empty()) return std::nullopt;
  return newest_first_.front();
}

std::size_t LightVersions::bytes() const {
  const std::lock_guard lock(mutex_);
  std::size_t sum = 0;
  for (const VersionedLight& light : newest_first_) sum += light.store->bytes();
  return sum;
}

}  // namespace cyclorama::node

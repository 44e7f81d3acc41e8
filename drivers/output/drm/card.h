// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "common/base/unique_fd.h"
#include "drivers/output/drm/connector.h"
#include "drivers/output/drm/properties.h"

namespace cyclorama::output {

struct Crtc {
  Properties properties;
  [[nodiscard]] std::uint32_t id() const { return properties.object_id(); }
};

/// A plane that a CRTC scans out. Only primary planes are used; each CRTC has one.
struct DrmPlane {
  Properties properties;
  std::uint32_t possible_crtcs = 0;
  bool is_primary = false;
  std::vector<std::uint32_t> formats;
  [[nodiscard]] std::uint32_t id() const { return properties.object_id(); }
  [[nodiscard]] bool can_show(std::uint32_t format) const;
};

/// A graphics card opened for atomic modesetting, with its constant resources and the DRM master right, which is needed
/// for modesets and flips. Move-only, thread-bound.
class Card {
 public:
  /// Errors: kNotFound if there is no such node; kUnavailable if the card drives no connectors or lacks atomic
  /// modesetting; kBusy if another process is its master; kSystem with the text of errno otherwise.
  static Result<Card> open(const std::filesystem::path& path);

  [[nodiscard]] int fd() const { return fd_.get(); }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const std::vector<Crtc>& crtcs() const { return crtcs_; }
  [[nodiscard]] const std::vector<DrmPlane>& planes() const { return planes_; }
  /// True if the card's timestamps are on CLOCK_MONOTONIC.
  [[nodiscard]] bool has_monotonic_time() const { return has_monotonic_time_; }

  /// Reads the state of all connectors. Those for whose id `is_probed` returns true are probed, which takes tens of
  /// milliseconds each; of others the kernel's present knowledge is read. A connector that vanishes meanwhile is
  /// omitted. Any thread may call it while another uses the card. Errors: from errno.
  [[nodiscard]] Result<std::vector<Connector>> read_connectors(
      const std::function<bool(std::uint32_t)>& is_probed) const;
  /// Acquires the DRM master right again. Errors: kSystem or kBusy if another process still has it.
  [[nodiscard]] Status become_master() const;

 private:
  Card() = default;
  Status read_crtcs();
  Status read_planes();

  std::filesystem::path path_;
  UniqueFd fd_;
  std::vector<Crtc> crtcs_;
  std::vector<DrmPlane> planes_;
  bool has_monotonic_time_ = false;
};

/// Returns the cards of this machine that have connectors, ordered by name; may be empty. Errors: from errno.
Result<std::vector<std::filesystem::path>> list_cards();

}  // namespace cyclorama::output

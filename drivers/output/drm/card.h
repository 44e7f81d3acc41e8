// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "common/base/unique_fd.h"
#include "drivers/output/drm/connector.h"
#include "drivers/output/drm/properties.h"

namespace cyclorama::output {

struct Crtc {
  Properties properties;
  [[nodiscard]] std::uint32_t id() const { return properties.object_id(); }
};

/// A layer that a CRTC scans out. Each CRTC has a primary one, which is all that is used here.
struct DrmPlane {
  Properties properties;
  std::uint32_t possible_crtcs = 0;
  bool is_primary = false;
  std::vector<std::uint32_t> formats;
  [[nodiscard]] std::uint32_t id() const { return properties.object_id(); }
  [[nodiscard]] bool can_show(std::uint32_t format) const;
};

/// A graphics card that is open for atomic mode setting: what never changes of it, and the right to change the rest
/// ("master"). Move-only, thread-bound.
class Card {
 public:
  /// kNotFound  no such node.     kUnavailable  it drives no connectors, or lacks atomic mode setting.
  /// kBusy  another process is its master.     kSystem  errno says why.
  static Result<Card> open(const std::filesystem::path& path);

  [[nodiscard]] int fd() const { return fd_.get(); }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const std::vector<Crtc>& crtcs() const { return crtcs_; }
  [[nodiscard]] const std::vector<DrmPlane>& planes() const { return planes_; }
  /// Its timestamps are CLOCK_MONOTONIC's.
  [[nodiscard]] bool has_monotonic_time() const { return has_monotonic_time_; }

  /// All connectors as they are now. One that vanishes while it is asked is left out; other errors as errno says.
  [[nodiscard]] Result<std::vector<Connector>> probe() const;
  /// Takes back the right to change modes. kSystem, kBusy  another process still has it.
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

/// The cards of this machine that have connectors, in the order of their names. Empty when there is none.
/// Errors as errno says.
Result<std::vector<std::filesystem::path>> list_cards();

}  // namespace cyclorama::output

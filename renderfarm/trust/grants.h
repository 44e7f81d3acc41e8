// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::trust {

/// The rights of one museum. A value. The default is everything, as on a farm without grants.
struct Grant {
  std::string museum{};                  ///< Common name in its certificate; empty if the museum states its name.
  std::vector<std::string> scenes{"*"};  ///< Names of scenes; "*" alone means all.
  double weight = 1.0;                   ///< Share of the nodes, relative to other museums.
  int sessions = 64;                     ///< Maximum number of simultaneous sessions.
  double bytes_per_second = 0.0;         ///< Limit for all its sessions together; 0: not limited.
  double cores = 0.0;                    ///< Quota of processors for all its sessions together; 0: no quota.
  double megapixels_per_second = 0.0;    ///< Quota of requested pictures; 0: no quota.
  int samples = 4096;                    ///< Maximum samples per pixel of a view.
  int bounces = 64;                      ///< Maximum bounces of a view.
  double scene_bytes = 0.0;              ///< Maximum memory of the scenes that it has open at once; 0: not limited.
  bool free_eye = false;                 ///< True if eyes may be anywhere and move at any pace (see ViewGuard).
  std::int64_t views_per_day = 0;        ///< Maximum views per day; 0: not limited.
  std::int64_t places_per_day = 0;       ///< Maximum distinct places per day, in all scenes; 0: not limited.
  std::uint64_t watermark = 0;           ///< Key of the watermark in its pictures; 0: none.
  bool updates = true;                   ///< True if the museum may fetch versions of its image.

  [[nodiscard]] bool allows(std::string_view scene) const;
  bool operator==(const Grant&) const = default;
};

/// The farm's museums.toml:
///
///   # museums.toml
///   [[museum]]
///   name = "hall-3"                  # Common name in its certificate.
///   scenes = ["grotto", "relic"]     # Or ["*"] for all.
///   weight = 2.0                     # Default: 1. From 0.01 to 100.
///   sessions = 4                     # Simultaneous sessions. Default: 4.
///   megabytes_per_s = 20             # Default: not limited. From 0.1.
///   cores = 16                       # Default: no quota. From 0.1. Beyond it, the museum gets what others leave.
///   megapixels_per_s = 60            # Default: no quota. From 0.01. Like `cores`, but for requested pictures.
///   samples = 256                    # Default: 4096. From 1. Views with more samples are refused.
///   bounces = 16                     # Default: 64. From 0. Views with more bounces are refused.
///   free_eye = true                  # Default: false, and views from where no visitor could be are refused.
///   views_per_day = 2000000          # Default: not limited. From 1.
///   places_per_day = 20000           # Default: not limited. From 1. Counts squares of 0.25 m that contain an eye.
///   scene_gib = 24                   # Default: not limited. From 0.1. Memory of the scenes that are open at once.
///   updates = false                  # Default: true. Whether the museum gets versions of its image from this farm.
///   watermark = "9e1f2bad2af9ea4e"   # Default: none. 16 hexadecimal digits, not all 0.
///
/// A museum that is not listed has no rights. A value; thread-bound.
class Grants {
 public:
  /// Parses museums.toml; errors quote `name` as the file name. Errors: those of Config.
  static Result<Grants> parse(std::string_view text, const std::string& name);
  /// Returns null if the museum has no grant.
  [[nodiscard]] const Grant* find(std::string_view museum) const;
  /// Returns all grants, keyed by the museum's name.
  [[nodiscard]] const std::map<std::string, Grant, std::less<>>& all() const { return grants_; }
  [[nodiscard]] std::size_t size() const { return grants_.size(); }

 private:
  std::map<std::string, Grant, std::less<>> grants_;
};

}  // namespace cyclorama::trust

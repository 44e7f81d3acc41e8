// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::trust {

/// Rights of one museum. A value. The default is that of a farm without grants: everything.
struct Grant {
  std::string museum{};                  ///< Common name of its certificate; empty if it states its own name.
  std::vector<std::string> scenes{"*"};  ///< "*" alone means all.
  double weight = 1.0;                   ///< Its share of the nodes, relative to other museums.
  int sessions = 64;                     ///< Maximum number of simultaneous sessions.
  double bytes_per_second = 0.0;         ///< For all its sessions together; 0: not limited.
  double cores = 0.0;                    ///< Quota of processors for all its sessions together; 0: none.
  double megapixels_per_second = 0.0;    ///< Quota of requested pictures; 0: none.
  int samples = 4096;                    ///< Maximum per pixel of a view.
  int bounces = 64;                      ///< Maximum of a view.
  double scene_bytes = 0.0;              ///< Memory of the scenes that it has open at once; 0: not limited.
  bool free_eye = false;                 ///< Eyes may be anywhere and move at any pace (see ViewGuard).
  std::int64_t views_per_day = 0;        ///< 0: not limited.
  std::int64_t places_per_day = 0;       ///< Distinct ones, of all scenes; 0: not limited.
  std::uint64_t watermark = 0;           ///< Key of the watermark in its pictures; 0: none.
  bool updates = true;                   ///< May fetch versions of its image.

  [[nodiscard]] bool allows(std::string_view scene) const;
  bool operator==(const Grant&) const = default;
};

/// The farm's museums.toml:
///
///   # museums.toml
///   [[museum]]
///   name = "hall-3"                  # As in its certificate.
///   scenes = ["grotto", "relic"]     # Or ["*"].
///   weight = 2.0                     # Left out: 1. From 0.01 to 100.
///   sessions = 4                     # Left out: 4. At once.
///   megabytes_per_s = 20             # Left out: not limited. From 0.1.
///   cores = 16                       # Left out: no quota. Beyond it, the museum gets what others leave. From 0.1.
///   megapixels_per_s = 60            # Left out: no quota. The same for the pictures that it requests. From 0.01.
///   samples = 256                    # Left out: 4096. Of a view; others are refused. From 1.
///   bounces = 16                     # Left out: 64. The same. From 0.
///   free_eye = true                  # Left out: false. Views from where no visitor could be are refused.
///   views_per_day = 2000000          # Left out: not limited. From 1.
///   places_per_day = 20000           # Left out: not limited. Squares of 0.25 m that it sees pictures from. From 1.
///   scene_gib = 24                   # Left out: not limited. Of scenes that it has open at once. From 0.1.
///   updates = false                  # Left out: true. Whether it gets versions of its image from here.
///   watermark = "9e1f2bad2af9ea4e"   # Left out: none. 16 hexadecimal digits, not all 0.
///
/// A museum that is not listed has no rights. A value; thread-bound.
class Grants {
 public:
  /// Errors: those of Config.
  static Result<Grants> parse(std::string_view text, const std::string& name);
  /// Returns null if the museum has no grant.
  [[nodiscard]] const Grant* find(std::string_view museum) const;
  /// Keyed by the museum's name.
  [[nodiscard]] const std::map<std::string, Grant, std::less<>>& all() const { return grants_; }
  [[nodiscard]] std::size_t size() const { return grants_.size(); }

 private:
  std::map<std::string, Grant, std::less<>> grants_;
};

}  // namespace cyclorama::trust

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

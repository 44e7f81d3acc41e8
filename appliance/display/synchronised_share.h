// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/base/clock.h"

namespace cyclorama::display {

/// The share of the last minute's refreshes that showed the frame that was due at them. Thread-bound.
class SynchronisedShare {
 public:
  /// Records `refreshes` more refreshes; for `late` of them, the frame now on screen was already due but not yet shown.
  /// Both are at least 0.
  void add(TimePoint now, std::int64_t refreshes, std::int64_t late);
  /// Returns the share; empty if there were no refreshes.
  [[nodiscard]] std::optional<double> share(TimePoint now) const;

 private:
  struct Second {
    std::int64_t number = -1;
    std::int64_t refreshes = 0;
    std::int64_t late = 0;
  };
  static constexpr std::int64_t kSeconds = 60;
  std::array<Second, kSeconds> seconds_{};
};

}  // namespace cyclorama::display

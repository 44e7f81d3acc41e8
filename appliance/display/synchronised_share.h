// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/base/clock.h"

namespace cyclorama::display {

/// Which share of the last minute's refreshes showed the frame that was to be shown at them. Thread-bound.
class SynchronisedShare {
 public:
  /// Refreshes passed, and before some of them a frame was missing that is seen now. Both at least 0.
  void add(TimePoint now, std::int64_t refreshes, std::int64_t late);
  /// Nothing when there were no refreshes.
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

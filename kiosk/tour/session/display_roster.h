// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "common/wire/inspection.pb.h"
#include "common/wire/museum.pb.h"

namespace cyclorama::tour {

/// The displays that show the tour, and how well they report to be synchronised. Thread-safe.
class DisplayRoster {
 public:
  void joined(std::uint64_t display, const wire::DisplayHello& hello);
  void left(std::uint64_t display);
  void heard(std::uint64_t display, const wire::ClockRequest& question);

  /// Returns the minimum of the displays' shares; nothing while fewer than two have reported one.
  [[nodiscard]] std::optional<double> synchronised_share() const;
  /// Returns the table "displays": name, heads, refresh_hz, synchronised_percent, clock_skew_ms, clock_error_ms,
  /// frame_need_ms.
  [[nodiscard]] wire::Table table() const;

 private:
  struct Member {
    wire::DisplayHello hello;
    wire::ClockRequest newest;
    double frame_need_s = 0.0;  ///< Newest measured value.
  };
  mutable std::mutex mutex_;  ///< Guards the following.
  std::map<std::uint64_t, Member> members_;
};

}  // namespace cyclorama::tour

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "appliance/healing/estimator/continuous_calibrator.h"
#include "common/wire/inspection.pb.h"

namespace cyclorama::healing {

/// State of each projector for pages: one table of the present and one of the last ten minutes. Thread-bound.
///
///   "watched projectors"   projector, state, reason, off_px, sigma_px, corrections, last_correction_px,
///                          last_correction_s (ago), wants_scan
///   "watched history"      s (ago), then off_px of each projector, under its name; the oldest first
class HealingHealth {
 public:
  static constexpr Duration kEvery = std::chrono::seconds(5);
  static constexpr std::size_t kMaxSamples = 120;

  /// `pixels` is the factor by which the calibration's pictures are smaller than the projectors', each way.
  HealingHealth(std::vector<std::string> projectors, double pixels) : names_(std::move(projectors)), pixels_(pixels) {
    last_.resize(names_.size());
  }

  void take(const ShowReport& report, TimePoint now);
  [[nodiscard]] wire::Table projectors(TimePoint now) const;
  [[nodiscard]] wire::Table history(TimePoint now) const;
  /// Returns one sentence: "keeps 3 projectors in place", or which of them are held, and why.
  [[nodiscard]] std::string sentence() const;
  /// False while a projector needs a scan.
  [[nodiscard]] bool is_well() const;

 private:
  struct Last {
    int corrections = 0;
    double moved_px = 0.0;
    TimePoint at{};
  };
  struct Sample {
    TimePoint at{};
    std::vector<std::optional<double>> off_px;
  };
  std::vector<std::string> names_;
  double pixels_;
  std::vector<ProjectorHealth> health_;
  std::vector<Last> last_;
  std::deque<Sample> history_;
};

}  // namespace cyclorama::healing

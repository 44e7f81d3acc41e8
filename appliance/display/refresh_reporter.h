// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "appliance/display/presenter.h"
#include "appliance/display/synchronised_share.h"
#include "common/wire/inspection_service.h"
#include "common/wire/museum.pb.h"
#include "drivers/output/pacing_meter.h"

namespace cyclorama::display {

/// Turns refreshes into statistics for the operator and reports for the tour. docs/reference/frame-timing.md names the
/// stages. Thread-bound.
class RefreshReporter {
 public:
  /// `heads` are those of the output, in order.
  RefreshReporter(InspectionService* inspection, const std::vector<std::string>& heads);

  /// Returns a report if the refresh was the first one of a frame.
  std::optional<wire::FramePresented> take(const RefreshEvent& event);
  void take(const HeadRefresh& refresh);
  /// Records that no head shows anything until more refreshes come.
  void output_lost();
  void frame_dropped(const std::string& reason);
  /// Records a frame that is shown without depth, because its depth was missing or damaged.
  void frame_without_depth(const std::string& trouble);
  /// Updates the rates about once a second. To be called more often than that.
  void tick(TimePoint now);

  [[nodiscard]] double frames_per_second() const { return frames_per_second_; }
  /// Share of the last minute's refreshes that were synchronised; empty if no other display shows the tour.
  [[nodiscard]] std::optional<double> synchronised_share(TimePoint now) const { return step_.share(now); }

 private:
  void take_step(const RefreshEvent& event);
  /// Names of one head's statistics, and its pacing.
  struct Head {
    std::string interval;
    std::string age;
    std::string late;
    std::string missed;
    std::string lit;
    bool is_lit = false;
    output::PacingMeter pacing;
  };

  InspectionService& inspection_;
  std::vector<Head> heads_;
  std::optional<std::uint64_t> last_refresh_;
  TimePoint counted_since_{};
  int refreshes_ = 0;
  int poses_ = 0;  // Refreshes that showed another pose than the refresh before.
  double last_heading_rad_ = 0.0;
  Eigen::Vector3d last_eye_m_ = Eigen::Vector3d::Zero();
  int frames_ = 0;
  double frames_per_second_ = 0.0;
  SynchronisedShare step_;
  std::optional<std::int64_t> last_synchronised_refresh_;
};

}  // namespace cyclorama::display

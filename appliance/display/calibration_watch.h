// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "appliance/display/atomic_slot.h"
#include "appliance/display/calibrated_heads.h"
#include "appliance/display/head_set.h"
#include "appliance/display/shown_parts.h"
#include "common/base/clock.h"

namespace cyclorama::display {

/// What a change of the calibration comes to, made ready for the presenter.
struct CalibrationUpdate {
  std::optional<Error> trouble;        ///< Why it cannot be used; then the rest is empty.
  std::string date;                    ///< The calibration's.
  std::vector<std::string> lacking;    ///< As CalibratedHeads,
  std::vector<std::string> corrected;  ///< and these.
  std::unique_ptr<HeadSet> set;
  std::vector<HeadFootprint> footprints;
};

/// Looks after a calibration's folder, four times a second, on a thread of its own, and reads it whenever the
/// calibration that counts has changed: its files are replaced by renames, so what is read is whole.
class CalibrationWatch {
 public:
  /// `planned`: what heads keep of which a calibration knows nothing.
  CalibrationWatch(std::filesystem::path folder, Installation installation, PictureShape picture,
                   std::vector<HeadPlan> planned);

  /// Reads it now, if there is one: kNotFound. For the start, before run().
  Result<CalibratedHeads> read();
  /// Begins to look.
  void run();
  /// What was read since; null: nothing new.
  [[nodiscard]] std::unique_ptr<CalibrationUpdate> take() { return news_.take(); }

 private:
  /// What tells that files are others than they were.
  [[nodiscard]] std::string mark() const;
  void find_colours();
  void look_until(const std::stop_token& stop);

  const std::filesystem::path folder_;
  const Installation installation_;
  const PictureShape picture_;
  const std::vector<HeadPlan> planned_;
  std::string mark_;                      // Of what was read.
  std::filesystem::path colours_folder_;  // Of it; empty: nothing could be read.
  AtomicSlot<CalibrationUpdate> news_;
  std::mutex mutex_;
  std::condition_variable_any woken_;
  std::jthread thread_;  // Last: it ends before what it uses.
};

}  // namespace cyclorama::display

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

/// A changed calibration, prepared for the presenter.
struct CalibrationUpdate {
  std::optional<Error> trouble;        ///< Set if the calibration cannot be used; all other members are then empty.
  std::string date;                    ///< Date of the calibration.
  std::vector<std::string> lacking;    ///< Same as CalibratedHeads::lacking.
  std::vector<std::string> corrected;  ///< Same as CalibratedHeads::corrected.
  std::unique_ptr<HeadSet> set;
  std::vector<HeadFootprint> footprints;
};

/// Checks a calibration's folder four times a second on a thread of its own, and reads the calibration again when its
/// files have changed. The files are replaced by renaming, so no read ever sees half a file.
class CalibrationWatch {
 public:
  /// `planned`: the heads of projectors that a calibration lacks.
  CalibrationWatch(std::filesystem::path folder, Installation installation, PictureShape picture,
                   std::vector<HeadPlan> planned);

  /// Reads the calibration on the caller's thread. Precondition: run() was not called. Errors: those of
  /// calibrated_heads().
  Result<CalibratedHeads> read();
  /// Starts the thread.
  void run();
  /// Returns the newest update since the last call; null if there is none.
  [[nodiscard]] std::unique_ptr<CalibrationUpdate> take() { return news_.take(); }

 private:
  /// Returns a text that changes whenever one of the files changes.
  [[nodiscard]] std::string mark() const;
  void find_colours();
  void look_until(const std::stop_token& stop);

  const std::filesystem::path folder_;
  const Installation installation_;
  const PictureShape picture_;
  const std::vector<HeadPlan> planned_;
  std::string mark_;  // Value of mark() for the files that were read last.
  // Folder of the calibration's colours; empty if calibration.json is unreadable.
  std::filesystem::path colours_folder_;
  AtomicSlot<CalibrationUpdate> news_;
  std::mutex mutex_;
  std::condition_variable_any woken_;
  std::jthread thread_;  // Last member, so that the thread ends before what it uses.
};

}  // namespace cyclorama::display

// SPDX-License-Identifier: Apache-2.0
/// A recorded part of a visit: the newest version of each picture, some pictures over time, and the states of the
/// processes.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/clock.h"
#include "common/image/image.h"
#include "common/image/jpeg.h"
#include "kiosk/operator/observation.h"

namespace cyclorama::operations {

/// Data of one picture.
struct RecordedPicture {
  std::string process;
  std::string name;
  RgbImage newest;
  double max_changed = 0.0;        ///< Maximum of changed_share() between any later picture and the first.
  RgbImage first;                  ///< Empty until a picture arrives.
  std::vector<RgbImage> overtime;  ///< Shrunk copies of the newest picture at each tick().
};

/// Data of one process.
struct RecordedProcess {
  ProcessObservation last;
  Duration max_absence{};  ///< Maximum since its first answer.
  std::optional<TimePoint> away_since;
  bool answered = false;
};

/// Takes samples only in look() and tick(), which the caller calls periodically. Thread-bound.
class Recording {
 public:
  explicit Recording(std::vector<ProcessLink> links);

  /// Requests the state and all pictures of every process; blocks at most two seconds for each process that hangs.
  void look(TimePoint now);
  /// Appends the newest version of each picture to its `overtime`.
  void tick();
  /// Resets absences and changes, which count from the start of the visit.
  void begin();

  [[nodiscard]] const std::vector<RecordedProcess>& processes() const { return processes_; }
  [[nodiscard]] const std::map<std::string, RecordedPicture>& pictures() const { return pictures_; }  ///< Key: name.
  [[nodiscard]] const wire::ProcessStatus* status_of(std::string_view process) const;
  /// Returns the number of frames presented so far, as counted by the tour.
  [[nodiscard]] double frames() const;
  /// Returns the number of refreshes so far that showed a new pose, as counted by the display.
  [[nodiscard]] double poses() const;

 private:
  [[nodiscard]] double gauge(std::string_view process, std::string_view name) const;
  void look_at(const ProcessLink& link, RecordedProcess* process, TimePoint now);
  void take_picture(const ProcessLink& link, const std::string& name);
  const std::vector<ProcessLink> links_;
  std::vector<RecordedProcess> processes_;
  std::map<std::string, RecordedPicture> pictures_;
  JpegDecoder decoder_;
};

}  // namespace cyclorama::operations

// SPDX-License-Identifier: Apache-2.0
/// A stretch of a visit, kept: the newest of each picture, some over time, and what the processes said.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/clock.h"
#include "common/image/image.h"
#include "common/image/jpeg.h"
#include "kiosk/operator/observation.h"

namespace cyclorama {

/// What came of one picture.
struct RecordedPicture {
  std::string process;
  std::string name;
  RgbImage newest;
  double most_changed = 0.0;       ///< Largest changed_share() between any look and the first.
  RgbImage first;                  ///< Empty until one came.
  std::vector<RgbImage> overtime;  ///< Shrunk, one for each tick(); the newest of then.
};

/// What came of one process.
struct RecordedProcess {
  Observation last;
  Duration longest_absence{};  ///< Since it first answered.
  std::optional<TimePoint> away_since;
  bool answered = false;
};

/// Looks when told to; the caller decides when. Thread-bound.
class Recording {
 public:
  explicit Recording(std::vector<ProcessLink> links);

  /// Asks every process for its state and all its pictures; blocks for two seconds at most per process that hangs.
  void look(TimePoint now);
  /// The newest of each picture takes its place in `overtime`.
  void tick();
  /// Forgets how it was until now, when the visit had not started: absences and changes count from here.
  void begin();

  [[nodiscard]] const std::vector<RecordedProcess>& processes() const { return processes_; }
  [[nodiscard]] const std::map<std::string, RecordedPicture>& pictures() const { return pictures_; }  ///< By name.
  [[nodiscard]] const wire::ProcessStatus* status_of(std::string_view process) const;
  /// Frames that were presented up to now, as the tour counts them.
  [[nodiscard]] double frames() const;

 private:
  void look_at(const ProcessLink& link, RecordedProcess* process, TimePoint now);
  void take_picture(const ProcessLink& link, const std::string& name);
  const std::vector<ProcessLink> links_;
  std::vector<RecordedProcess> processes_;
  std::map<std::string, RecordedPicture> pictures_;
  JpegDecoder decoder_;
};

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
/// A show and what its cameras saw of it, kept, so that the corrections that were made of it can be made again, bit by
/// bit: for the calibrator's --record and --replay.
///
///     FOLDER/installation.toml   the room's, copied: the wall
///     FOLDER/show.record         how it began, then each moment's pictures, as they are
///     FOLDER/report.txt          what came of it, a line per event, numbers as hexadecimal floats
///
/// show.record, all numbers little-endian:
///     "CYCSHOW2" u32 factor, u32 bytes, JSON of what is applied; u32 bytes, JSON of what was learned, or 0: not
///     settled
///
///     per moment: u8 1, i64 now_ns,
///                 u32 pictures, { u32 projector, i64 lit_ns, u64 number, u32 width, u32 height, RGB bytes },
///                 u32 projectors, { u32 projector, i64 at_ns, u64 number }: until when it is known what they showed
///                 u32 photographs, { u32 camera, i64 opened_ns, i64 closed_ns, u32 width, u32 height, grey bytes }
///     u8 2: somebody wanted a realignment
///     u8 3, u32 projector, f64 rotation w, x, y, z, place x, y, z: it was put back there
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "appliance/calibration/show_file.h"
#include "appliance/healing/estimator/continuous_calibrator.h"
#include "common/base/result.h"
#include "common/room/installation.h"

namespace cyclorama::healing {

/// Where the records of one folder are at their end, all together: so that a forgotten --record does not fill the disk,
/// however often the calibrator starts again.
inline constexpr std::uintmax_t kMaxRecordBytes = std::uintmax_t{8} << 30;

/// What a record begins with.
struct RecordStart {
  calibration::ShowCalibration applied;
  std::optional<LearnedRoom> learned;
  std::uint32_t factor = 1;  ///< By what its pictures are smaller than the projectors', each way.

  /// Where no learned room is there, one that begins. Errors of ContinuousCalibrator::make().
  [[nodiscard]] Result<ContinuousCalibrator> begin() const;
};

/// With what is applied; light that was not measured is taken for 2.2 gamma, cameras for linear.
[[nodiscard]] calibration::ShowCalibration show_of(const calibration::ShowFile& file, const Installation& installation);
/// What was learned, if all of it is there.
[[nodiscard]] std::optional<LearnedRoom> learned_of(const calibration::ShowFile& file,
                                                    const Installation& installation);
/// Into a file of the same room.
void put_learned(const LearnedRoom& learned, calibration::ShowFile* file);

/// A line per correction, and per line of the log: the same for the same report, and for no other.
[[nodiscard]] std::string report_lines(const ShowReport& report);

/// Of all that lies in a folder.
[[nodiscard]] std::uintmax_t record_bytes(const std::filesystem::path& folder);

/// Thread-bound.
class ShowRecorder {
 public:
  /// Makes the folder. kInvalidArgument  the wall is a mesh, which lies in other files.     kSystem  errno says why.
  static Result<ShowRecorder> begin(const std::filesystem::path& folder, const std::filesystem::path& installation,
                                    const RecordStart& start, std::uintmax_t max_bytes = kMaxRecordBytes);
  /// kSystem  errno says why, the disk is full; kBusy  it has its largest size: no more is kept.
  Status add(const ShowMoment& moment, const ShowReport& report);
  Status add_realignment();
  Status add_put_back(std::size_t projector, const RigidTransform<frame::Room, frame::Projector>& T_room_projector);

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  using File = std::unique_ptr<std::FILE, Close>;
  ShowRecorder(File record, File report, std::uintmax_t left)
      : record_(std::move(record)), report_(std::move(report)), left_(left) {}
  Status put(const std::string& bytes);
  File record_;
  File report_;
  std::uintmax_t left_;  ///< Bytes that may still be written.
};

/// Reads what a recorder wrote. Thread-bound.
class ShowRecord {
 public:
  /// kBadData  it is no record.     Others as read_file() and read_installation().
  static Result<ShowRecord> open(const std::filesystem::path& folder);
  [[nodiscard]] const RecordStart& start() const { return start_; }

  struct Event {
    bool wants_realignment = false;
    std::optional<std::size_t> put_back{};  ///< A projector, there:
    RigidTransform<frame::Room, frame::Projector> position{};
    ShowMoment moment;
  };
  /// Nothing at the end, also where the record is cut short. kBadData  what no recorder writes.
  Result<std::optional<Event>> next();

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  using File = std::unique_ptr<std::FILE, Close>;
  ShowRecord(File file, std::uintmax_t size, RecordStart start)
      : file_(std::move(file)), left_(size), start_(std::move(start)) {}
  File file_;
  std::uintmax_t left_;  ///< Bytes.
  RecordStart start_;
};

/// Runs it again; every report's lines, one after the other. Errors as ShowRecord's and ContinuousCalibrator::make()'s.
Result<std::string> replay(const std::filesystem::path& folder);

}  // namespace cyclorama::healing

// SPDX-License-Identifier: Apache-2.0
/// A recorded show with its cameras' pictures, so that its corrections can be reproduced bit by bit: for the
/// calibrator's --record and --replay.
///
///     FOLDER/installation.toml   copy of the room's file; gives the wall
///     FOLDER/show.record         initial state, then each moment's pictures, unchanged
///     FOLDER/report.txt          results, a line per event, numbers as hexadecimal floats
///
/// show.record, all numbers little-endian:
///     "CYCSHOW2" u32 factor, u32 bytes, JSON of the applied room; u32 bytes, JSON of the learned room, or 0: not
///     learned yet
///
///     per moment: u8 1, i64 now_ns,
///                 u32 pictures, { u32 projector, i64 lit_ns, u64 number, u32 width, u32 height, RGB bytes },
///                 u32 projectors, { u32 projector, i64 at_ns, u64 number }: times until which their pictures are known
///                 u32 photographs, { u32 camera, i64 opened_ns, i64 closed_ns, u32 width, u32 height, grey bytes }
///     u8 2: a realignment was requested
///     u8 3, u32 projector, f64 rotation w, x, y, z, position x, y, z: the projector was put back to this pose
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

/// Upper bound of the size of all records of one folder together, so that a forgotten --record does not fill the disk,
/// however often the calibrator restarts.
inline constexpr std::uintmax_t kMaxRecordBytes = std::uintmax_t{8} << 30;

/// Initial state of a record.
struct RecordStart {
  calibration::ShowCalibration applied;
  std::optional<LearnedRoom> learned;
  std::uint32_t factor = 1;  ///< Factor by which pictures are smaller than the projectors', each way.

  /// Resumes the learned room, or begins a new one if there is none. Errors: those of ContinuousCalibrator::make().
  [[nodiscard]] Result<ContinuousCalibrator> begin() const;
};

/// Returns the applied room; an unmeasured response is taken as gamma 2.2 for projectors, as linear for cameras.
[[nodiscard]] calibration::ShowCalibration show_of(const calibration::ShowFile& file, const Installation& installation);
/// Returns the learned room; empty if a part of it is missing.
[[nodiscard]] std::optional<LearnedRoom> learned_of(const calibration::ShowFile& file,
                                                    const Installation& installation);
/// Stores `learned` in a file of the same room.
void put_learned(const LearnedRoom& learned, calibration::ShowFile* file);

/// Returns one line of text per correction, noticed displacement and line of the report's log.
[[nodiscard]] std::string report_lines(const ShowReport& report);

/// Returns the size of all records in a folder.
[[nodiscard]] std::uintmax_t record_bytes(const std::filesystem::path& folder);

/// Writes a record. Thread-bound.
class ShowRecorder {
 public:
  /// Creates the folder and its files. Errors: kInvalidArgument if the wall is a mesh, whose file a record does not
  /// contain; kSystem with errno.
  static Result<ShowRecorder> begin(const std::filesystem::path& folder, const std::filesystem::path& installation,
                                    const RecordStart& start, std::uintmax_t max_bytes = kMaxRecordBytes);
  /// Adds a moment and its report. Errors: kSystem with errno, for instance if the disk is full; kBusy if the record
  /// has reached its maximum size; nothing more is recorded.
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

/// Reads a record. Thread-bound.
class ShowRecord {
 public:
  /// Opens the record of a folder. Errors: kNotFound if there is no record; kBadData if it is invalid; those of
  /// read_installation().
  static Result<ShowRecord> open(const std::filesystem::path& folder);
  [[nodiscard]] const RecordStart& start() const { return start_; }

  struct Event {
    bool wants_realignment = false;
    std::optional<std::size_t> put_back{};  ///< Projector that was put back, to the pose `position`.
    RigidTransform<frame::Room, frame::Projector> position{};
    ShowMoment moment;
  };
  /// Returns the next event; empty at the end, also if the record is truncated. Errors: kBadData if the contents are
  /// invalid.
  Result<std::optional<Event>> next();

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  using File = std::unique_ptr<std::FILE, Close>;
  ShowRecord(File file, std::uintmax_t size, RecordStart start)
      : file_(std::move(file)), left_(size), start_(std::move(start)) {}
  File file_;
  std::uintmax_t left_;  ///< Bytes that have not been read yet.
  RecordStart start_;
};

/// Runs the record again and returns the lines of every report, in order. Errors: those of ShowRecord and
/// ContinuousCalibrator::make().
Result<std::string> replay(const std::filesystem::path& folder);

}  // namespace cyclorama::healing

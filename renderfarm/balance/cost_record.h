// SPDX-License-Identifier: Apache-2.0
/// The costs of a session's frames in a file, which cyclorama-bench-balance replays.
///
///     "CYCOST1\n" { frame }                                              little-endian
///     frame   u32 bytes that follow   u32 width_px   u32 height_px
///             f64 heading_rad   f64 azimuth_span_rad   f64 eye x, y, z (metres)   f64 effort
///             f32 work of each cell of 16x16 pixels, row by row, in seconds at speed 1
///
/// A frame takes about 8 kB at 960x540, 33 kB at 1920x1080.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/base/unique_fd.h"
#include "renderfarm/balance/work_grid.h"

namespace cyclorama::balance {

struct RecordedFrame {
  WorkGrid work;  ///< Finite and not negative.
  double heading_rad = 0.0;
  double azimuth_span_rad = 1.0;
  std::array<double, 3> eye_m{};
  double effort = 1.0;  ///< See SplitRequest::effort.
};

inline constexpr std::size_t kMaxRecordBytes = std::size_t{1} << 30;

/// Returns all complete frames of a record. Omits a truncated last frame, which remains if the coordinator was killed.
/// Errors: kBadData, with reason and position, if the file is not a record or contains a frame that no recorder writes.
Result<std::vector<RecordedFrame>> parse_cost_record(std::span<const std::byte> bytes, std::string_view name);
/// Reads a record of at most kMaxRecordBytes. Errors: those of parse_cost_record() and of read_file().
Result<std::vector<RecordedFrame>> read_cost_record(const std::filesystem::path& path);

/// Writes one record. Each frame is written with one call, so a killed process loses at most its last frame.
/// Thread-bound; blocks for as long as the disk does.
class CostRecorder {
 public:
  /// Creates a new file. Errors: kBusy if it exists; kSystem with errno otherwise.
  static Result<CostRecorder> create(const std::filesystem::path& path);

  /// Appends a frame. Errors: kInvalidArgument, and nothing is written, if the picture has no cells or more than 2^20,
  /// or if a value is not finite; kUnavailable if the file has reached kMaxRecordBytes; kSystem if the disk is full or
  /// fails.
  Status add(const RecordedFrame& frame);
  /// Appends a frame from the nodes' measurements; unmeasured cells count as no work.
  Status add(const RecordedFrame& frame_without_work, PictureSize size, std::span<const MeasuredBlock> blocks);

 private:
  CostRecorder(UniqueFd fd, std::filesystem::path path) : fd_(std::move(fd)), path_(std::move(path)) {}
  Status write(std::span<const std::byte> bytes);

  UniqueFd fd_;
  std::filesystem::path path_;
  std::size_t written_ = 0;
};

}  // namespace cyclorama::balance

// SPDX-License-Identifier: Apache-2.0
/// Cost maps of a visit, one after the other in a file: what cyclorama-balance replays.
///
///     "CYCOST1\n" { frame }                                              little-endian
///     frame   u32 bytes that follow   u32 width_px   u32 height_px
///             f64 heading_rad   f64 azimuth_span_rad   f64 eye x, y, z (metres)   f64 effort
///             f32 work of each cell of 16x16 pixels, row by row, in seconds at speed 1
///
/// About 8 kB a frame of 960x540, 33 kB of 1920x1080.
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

namespace cyclorama {

struct RecordedFrame {
  WorkGrid work;  ///< Finite, none negative.
  double heading_rad = 0.0;
  double azimuth_span_rad = 1.0;
  std::array<double, 3> eye_m{};
  double effort = 1.0;  ///< As in SplitRequest.
};

inline constexpr std::size_t kMostRecordBytes = std::size_t{1} << 30;

/// All whole frames of a record; a last one that was cut off (the head was killed) is left out.
/// kBadData  says what is wrong, and where: not a record, or a frame that no recorder writes.
Result<std::vector<RecordedFrame>> parse_cost_record(std::span<const std::byte> bytes, std::string_view name);
/// Errors also as read_file(). At most kMostRecordBytes.
Result<std::vector<RecordedFrame>> read_cost_record(const std::filesystem::path& path);

/// Writes one record. Each frame goes to the file whole, with one call, so that a killed process loses its last frame
/// at most. Thread-bound; blocks for as long as the disk does.
class CostRecorder {
 public:
  /// A new file. kBusy  it exists.   kSystem  errno says why.
  static Result<CostRecorder> create(const std::filesystem::path& path);

  /// kInvalidArgument  the picture has no cells, more than 2^20, or a number that is none: nothing is written.
  /// kUnavailable      the file has reached kMostRecordBytes.   kSystem  the disk is full or refuses.
  Status add(const RecordedFrame& frame);
  /// The same from what the nodes measured; cells that nobody measured count as no work.
  Status add(const RecordedFrame& frame_without_work, PictureSize size, std::span<const MeasuredBlock> blocks);

 private:
  CostRecorder(UniqueFd fd, std::filesystem::path path) : fd_(std::move(fd)), path_(std::move(path)) {}
  Status write(std::span<const std::byte> bytes);

  UniqueFd fd_;
  std::filesystem::path path_;
  std::size_t written_ = 0;
};

}  // namespace cyclorama

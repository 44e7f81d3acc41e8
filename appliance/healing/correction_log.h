// SPDX-License-Identifier: Apache-2.0
/// FOLDER/corrections.log: one line of JSON per correction, the newest last. Above one mebibyte it is renamed to
/// corrections.log.1, and a new file begins.
///
///     {"at": "2026-11-23T10:00:00Z", "projector": 2, "kind": "bump", "moved_px": 23.411, "sigma_px": 0.110,
///      "before": {"rotation_wxyz": [...], "position_m": [...]}, "after": {...}}
///
/// Projectors are counted from 1. The kind is bump, drift or undone; for undone, `before` is the pose of the correction
/// that was undone, and `after` the pose before that correction.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "appliance/healing/estimator/continuous_calibrator.h"

namespace cyclorama::healing {

struct LoggedCorrection {
  std::string at;  ///< Time in UTC.
  std::string kind;
  std::size_t projector = 0;  ///< Counted from 0.
  double moved_px = 0.0;      ///< In pixels of that projector.
  double sigma_px = 0.0;
  RigidTransform<frame::Room, frame::Projector> before;
  RigidTransform<frame::Room, frame::Projector> after;
};

/// Returns one line, without its newline.
[[nodiscard]] std::string correction_line(const LoggedCorrection& correction);
/// Parses one line; empty if the line is invalid.
[[nodiscard]] std::optional<LoggedCorrection> parse_correction(std::string_view line);

/// Appends to the log. Failures are ignored, since corrections do not depend on the log.
void log_corrections(const std::filesystem::path& folder, std::span<const LoggedCorrection> corrections);

/// Returns the last correction in force: the latest one whose `after` is still the pose for which its projector is
/// drawn. `applied` has these poses, one per projector. Invalid lines are skipped.
[[nodiscard]] std::optional<LoggedCorrection> last_correction(
    const std::filesystem::path& folder, std::span<const RigidTransform<frame::Room, frame::Projector>> applied);

/// Returns the present time in the log's format.
[[nodiscard]] std::string utc_now();

}  // namespace cyclorama::healing

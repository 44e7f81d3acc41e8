// SPDX-License-Identifier: Apache-2.0
/// FOLDER/corrections.log: a line of JSON per correction, the newest last; of one mebibyte or more it becomes
/// corrections.log.1, and a new one begins.
///
///     {"at": "2026-11-23T10:00:00Z", "projector": 2, "kind": "bump", "moved_px": 23.411, "sigma_px": 0.110,
///      "before": {"rotation_wxyz": [...], "position_m": [...]}, "after": {...}}
///
/// A projector is counted from 1; a kind is bump, drift, or undone: then `before` is the correction that was taken
/// back, and `after` what stood before it.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "appliance/healing/estimator/continuous_calibrator.h"

namespace cyclorama::healing {

struct LoggedCorrection {
  std::string at;  ///< UTC.
  std::string kind;
  std::size_t projector = 0;  ///< From 0.
  double moved_px = 0.0;      ///< Of its own pixels.
  double sigma_px = 0.0;
  RigidTransform<frame::Room, frame::Projector> before;
  RigidTransform<frame::Room, frame::Projector> after;
};

/// One line, without its end.
[[nodiscard]] std::string correction_line(const LoggedCorrection& correction);
/// The opposite; nothing where it is no such line.
[[nodiscard]] std::optional<LoggedCorrection> parse_correction(std::string_view line);

/// What cannot be written is not said here: the wall is kept in its place without a log.
void log_corrections(const std::filesystem::path& folder, std::span<const LoggedCorrection> corrections);

/// The last correction that stands: it was not taken back, and its projector is drawn for where it says (`applied`, by
/// projector). Lines that are none are passed over.
[[nodiscard]] std::optional<LoggedCorrection> last_correction(
    const std::filesystem::path& folder, std::span<const RigidTransform<frame::Room, frame::Projector>> applied);

/// Now, as the log has it.
[[nodiscard]] std::string utc_now();

}  // namespace cyclorama::healing

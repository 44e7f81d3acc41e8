// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::devices {

/// A line "KIND:ARGUMENT?key=value&key=value", split into its parts. Borrows the line.
struct CameraSpec {
  std::string_view line;
  std::string_view kind;
  std::string_view argument;
  std::vector<std::pair<std::string_view, std::string_view>> options;

  /// Splits any line; the meaning of the parts depends on the kind.
  static CameraSpec parse(std::string_view line);

  /// Returns kInvalidArgument with the line and the reason.
  [[nodiscard]] Error refused(std::string_view why) const;
  /// Reads a number within [min, max] from `text`. Errors: kInvalidArgument, with the key and the range.
  [[nodiscard]] Result<double> number(std::string_view key, std::string_view text, double min, double max) const;
};

/// Inserts `defaults` ("key=value&key=value") into the line of a V4L2 or libcamera camera, before its own options,
/// which take precedence. Other lines are returned unchanged, since recordings have no such options.
[[nodiscard]] std::string with_defaults(std::string_view line, std::string_view defaults);

/// Default picture size for a calibration, which locates correspondences to a fraction of a camera pixel.
inline constexpr std::string_view kCalibrationSize = "width_px=1920&height_px=1080";

}  // namespace cyclorama::devices

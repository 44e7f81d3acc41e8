// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::devices {

/// A line "KIND:ARGUMENT?key=value&key=value", cut. Borrows the line.
struct CameraSpec {
  std::string_view line;
  std::string_view kind;
  std::string_view argument;
  std::vector<std::pair<std::string_view, std::string_view>> options;

  /// Any line is one; what its words mean is its kind's.
  static CameraSpec parse(std::string_view line);

  /// kInvalidArgument, with the line.
  [[nodiscard]] Error refused(std::string_view why) const;
  /// A number within [least, most] from `text`. kInvalidArgument  names the key and the range.
  [[nodiscard]] Result<double> number(std::string_view key, std::string_view text, double min, double max) const;
};

/// The line of a V4L2 or libcamera camera with `defaults` ("key=value&key=value") before its own options, which count
/// where both have a word. Any other line as it is: recordings have no such options.
[[nodiscard]] std::string with_defaults(std::string_view line, std::string_view defaults);

/// What a calibration wants of a camera, where its line says nothing else: places are told to a part of its pixels.
inline constexpr std::string_view kCalibrationSize = "width_px=1920&height_px=1080";

}  // namespace cyclorama::devices

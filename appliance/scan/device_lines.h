// SPDX-License-Identifier: Apache-2.0
/// Texts of one line that name the devices of a calibration, as in settings and on command lines.
#pragma once

#include <string>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::scan {

/// A display and the projectors of the installation that it drives.
struct PatternDisplay {
  std::string address;                    ///< Address of its PatternScreen service: HOST:PORT or unix:PATH.
  std::vector<std::string> projectors{};  ///< Names; empty means all projectors.
};

/// Parses "HOST:PORT" or "left,middle=HOST:PORT". Errors: kInvalidArgument for any other form.
Result<PatternDisplay> parse_pattern_display(const std::string& text);

/// Returns the index of the display that drives a projector. Errors: kInvalidArgument if none or two do.
Result<std::size_t> display_of(const std::string& projector, const std::vector<PatternDisplay>& displays);

/// A fixed camera that watches the show.
struct CameraSource {
  std::string name;
  std::string spec;  ///< Argument for make_camera().
};

/// Parses "NAME=CAMERA". Errors: kInvalidArgument for any other form, or if !is_camera_name(NAME).
Result<CameraSource> parse_camera_source(const std::string& text);
/// Returns true for 1 to 60 letters, digits, '.', '-' and '_' that do not begin with '.' or '-': the camera's lens is
/// stored in NAME.json, which must be a valid file name on USB sticks too.
[[nodiscard]] bool is_camera_name(const std::string& name);

}  // namespace cyclorama::scan

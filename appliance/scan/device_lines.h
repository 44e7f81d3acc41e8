// SPDX-License-Identifier: Apache-2.0
/// The devices of a calibration as people write them, each in one line.
#pragma once

#include <string>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::scan {

/// A display, and which of the installation's projectors it drives.
struct PatternDisplay {
  std::string address;                    ///< HOST:PORT, or unix:PATH, of its PatternScreen service.
  std::vector<std::string> projectors{};  ///< By name; none: all.
};

/// "HOST:PORT", or "left,middle=HOST:PORT". kInvalidArgument  another form.
Result<PatternDisplay> parse_pattern_display(const std::string& text);

/// Which of the displays drives a projector. kInvalidArgument  none, or two.
Result<std::size_t> display_of(const std::string& projector, const std::vector<PatternDisplay>& displays);

/// A fixed camera that watches the show.
struct CameraSource {
  std::string name;
  std::string spec;  ///< For make_camera().
};

/// "NAME=CAMERA". kInvalidArgument  another form, or a name that is no file's.
Result<CameraSource> parse_camera_source(const std::string& text);
/// Letters, digits, '.', '-' and '_', 60 at most, not beginning with '.' or '-': its lens is NAME.json, also on a
/// stick.
[[nodiscard]] bool is_camera_name(const std::string& name);

}  // namespace cyclorama::scan

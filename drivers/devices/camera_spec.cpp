// SPDX-License-Identifier: Apache-2.0
#include "drivers/devices/camera_spec.h"

#include <fmt/format.h>

#include "common/base/text.h"
#include "drivers/devices/device_line.h"

namespace cyclorama::devices {

CameraSpec CameraSpec::parse(std::string_view line) {
  CameraSpec spec;
  spec.line = line;
  std::string_view rest = line;
  std::string_view before_options = cut(&rest, '?');
  spec.kind = cut(&before_options, ':');
  spec.argument = before_options;
  while (!rest.empty()) {
    std::string_view value = cut(&rest, '&');
    const std::string_view key = cut(&value, '=');
    spec.options.emplace_back(key, value);
  }
  return spec;
}

Error CameraSpec::refused(std::string_view why) const {
  return {ErrorCode::kInvalidArgument, fmt::format("camera '{}': {}", printable(line, 200), why)};
}

Result<double> CameraSpec::number(std::string_view key, std::string_view text, double min, double max) const {
  const auto value = parse_double(text);
  if (!value || !(*value >= min && *value <= max)) {
    return refused(fmt::format("{} must be a number from {:g} to {:g}", key, min, max));
  }
  return *value;
}

std::string with_defaults(std::string_view line, std::string_view defaults) {
  std::string_view own = line;
  const std::string_view camera = cut(&own, '?');
  if (!camera.starts_with("v4l2:") && !camera.starts_with("libcamera:")) return std::string(line);
  return fmt::format("{}?{}{}{}", camera, defaults, own.empty() ? "" : "&", own);
}

}  // namespace cyclorama::devices

// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/device_lines.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/address.h"
#include "common/base/text.h"

namespace cyclorama::scan {

Result<PatternDisplay> parse_pattern_display(const std::string& text) {
  PatternDisplay display;
  const std::size_t equals = text.find('=');
  display.address = equals == std::string::npos ? text : text.substr(equals + 1);
  if (equals != std::string::npos) {
    std::string names = text.substr(0, equals) + ",";
    for (std::size_t comma; (comma = names.find(',')) != std::string::npos; names.erase(0, comma + 1)) {
      if (comma == 0) {
        return Error(
            ErrorCode::kInvalidArgument,
            fmt::format("'{}' names no projector before the '='; write left,middle=HOST:PORT", printable(text, 200)));
      }
      display.projectors.push_back(names.substr(0, comma));
    }
  }
  if (!is_unix_socket(display.address)) TRY(parse_address(display.address));
  return display;
}

Result<std::size_t> display_of(const std::string& projector, const std::vector<PatternDisplay>& displays) {
  std::vector<std::size_t> drives;
  for (std::size_t d = 0; d < displays.size(); ++d) {
    const auto& names = displays[d].projectors;
    if (names.empty() || std::find(names.begin(), names.end(), projector) != names.end()) drives.push_back(d);
  }
  if (drives.size() == 1) return drives.front();
  return Error(
      ErrorCode::kInvalidArgument,
      fmt::format("projector '{}' belongs to {} displays; name each at one, as NAMES=HOST:PORT, with --display "
                  "or at displays in calibrator.toml",
                  projector, drives.size()));
}

bool is_camera_name(const std::string& name) {
  return !name.empty() && name.size() <= 60 && name[0] != '.' && name[0] != '-' &&
         std::ranges::all_of(name, [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '-' ||
                  c == '_';
         });
}

Result<CameraSource> parse_camera_source(const std::string& text) {
  const std::size_t equals = text.find('=');
  CameraSource plug;
  if (equals != std::string::npos) plug = {text.substr(0, equals), text.substr(equals + 1)};
  if (is_camera_name(plug.name) && !plug.spec.empty()) return plug;
  return Error(ErrorCode::kInvalidArgument,
               fmt::format("'{}' names no camera; write NAME=CAMERA, such as left=v4l2:usb-0000:00:14.0-2; a name has "
                           "letters, digits, '.', '-' and '_'",
                           printable(text, 200)));
}

}  // namespace cyclorama::scan

// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/camera_settings.h"

#include <fmt/format.h>

#include <array>

namespace cyclorama::camera {
namespace {

constexpr const char* kPortKey = "port";
constexpr const char* kPath = "device";
/// Keys that are valid only beside `kind`, since a `source` line contains their values.
constexpr std::array kKeysOfKind{kPortKey,      kPath,   "width_px", "height_px", "frames_per_second",
                                 "exposure_ms", "memory"};

/// Returns the camera's port path or file; rejects characters that begin an option, since no port path contains them.
std::string device_of(const std::string& kind, ConfigTable* camera) {
  if (camera->has(kPortKey) && camera->has(kPath))
    camera->refuse(kPath, "and port name the same camera twice; remove one");
  const char* const key = camera->has(kPath) ? kPath : kPortKey;
  const std::string device = camera->text(key, "");
  if (device.find_first_of("?&\n") != std::string::npos)
    camera->refuse(key, "holds '?', '&' or a line's end; no port does");
  if (key == kPath && !device.starts_with("/")) camera->refuse(kPath, "must be a path, as /dev/v4l/by-path/...");
  // A V4L2 port is not a file path, whereas libcamera's ids are device tree paths.
  if (key == kPortKey && kind == "v4l2" && device.starts_with("/")) {
    camera->refuse(kPortKey, "is a path; write device = \"...\"");
  }
  return device;
}

}  // namespace

std::string camera_source(ConfigTable* camera, const std::string& fallback) {
  if (!camera->has("kind")) {
    for (const char* key : kKeysOfKind) {
      if (camera->has(key)) camera->refuse(key, "needs kind = \"v4l2\" or \"libcamera\"");
    }
    return camera->text("source", fallback);
  }
  if (camera->has("source")) camera->refuse("source", "and kind say the same; remove one");
  const std::string kind = camera->choice("kind", {"v4l2", "libcamera"});
  std::string options;
  const auto add = [&](const char* key, Range range) {
    if (camera->has(key)) options += fmt::format("&{}={:.9g}", key, camera->number(key, range));
  };
  std::string line = fmt::format("{}:{}", kind, device_of(kind, camera));
  add("width_px", {16, 8192});
  add("height_px", {16, 8192});
  add("frames_per_second", {1, 1000});
  add("exposure_ms", {0, 1000});
  if (camera->has("memory")) {
    const std::string memory = camera->choice("memory", {"mapped", "dma_buf"});
    if (kind != "v4l2") camera->refuse("memory", "is an option of kind = \"v4l2\"");
    options += "&memory=" + memory;
  }
  if (!options.empty()) line += "?" + options.substr(1);
  return line;
}

}  // namespace cyclorama::camera

// SPDX-License-Identifier: Apache-2.0
#include "drivers/devices/make_camera.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>

#include "common/base/text.h"
#include "drivers/camera/file/file_camera.h"
#include "drivers/camera/libcamera/libcamera_camera.h"
#include "drivers/camera/v4l2/v4l2_camera.h"
#include "drivers/devices/camera_spec.h"
#include "drivers/simulated/camera/simulated_camera.h"

namespace cyclorama::devices {
namespace {

using Made = Result<std::unique_ptr<camera::Camera>>;

Made make_file_camera(const CameraSpec& spec, const Clock& clock) {
  camera::FileCameraOptions options;
  if (spec.argument.empty()) return spec.refused("names no file; write file:PATH");
  for (const auto& [key, value] : spec.options) {
    if (key == "frames_per_second") {
      options.frames_per_second = parse_double(value);
      if (!options.frames_per_second) return spec.refused("frames_per_second must be a number");
    } else if (key == "loop" && (value == "yes" || value == "no")) {
      options.loop = value == "yes";
    } else {
      return spec.refused("knows the options frames_per_second=N and loop=yes or loop=no");
    }
  }
  return camera::FileCamera::open(std::string(spec.argument), options, clock);
}

Made make_simulated_camera(const CameraSpec& spec, const Clock& clock) {
  simulated::Simulation simulation;
  if (!spec.options.empty()) return spec.refused("takes no options; they stand in its file");
  if (!spec.argument.empty()) {
    TRY_ASSIGN(simulation, simulated::Simulation::read(std::string(spec.argument)));
  }
  return std::unique_ptr<camera::Camera>(std::make_unique<simulated::SimulatedCamera>(std::move(simulation), clock));
}

/// Reads an option that all real cameras have; returns false for any other option.
Result<bool> read_option(const CameraSpec& spec, std::string_view key, std::string_view value,
                         camera::PicturePreference* ret_preferred, Duration* ret_exposure) {
  if (key == "width_px" || key == "height_px") {
    TRY_ASSIGN(const double pixels, spec.number(key, value, 16, 8192));
    (key == "width_px" ? ret_preferred->width_px : ret_preferred->height_px) = static_cast<int>(std::lround(pixels));
  } else if (key == "colour" && (value == "yes" || value == "no")) {
    ret_preferred->is_coloured = value == "yes";
  } else if (key == "frames_per_second") {
    TRY_ASSIGN(ret_preferred->frames_per_second, spec.number(key, value, 0.1, 1000));
  } else if (key == "exposure_ms") {
    TRY_ASSIGN(const double milliseconds, spec.number(key, value, 0, 10000));
    *ret_exposure = std::chrono::duration_cast<Duration>(std::chrono::duration<double, std::milli>(milliseconds));
  } else {
    return false;
  }
  return true;
}

Made make_v4l2_camera(const CameraSpec& spec, const Clock& clock) {
  camera::V4l2CameraOptions options;
  for (const auto& [key, value] : spec.options) {
    TRY_ASSIGN(const bool is_known, read_option(spec, key, value, &options.preferred, &options.exposure));
    if (is_known) continue;
    if (key == "gain" && (value == "held" || value == "automatic")) {
      options.gain = value == "held" ? camera::GainRule::kHeld : camera::GainRule::kFollowsLight;
      continue;
    }
    if (key != "memory" || (value != "mapped" && value != "dma_buf")) {
      return spec.refused(
          "knows the options width_px, height_px, frames_per_second, exposure_ms, colour=yes or no, "
          "gain=held or automatic, memory=mapped or dma_buf");
    }
    options.memory = value == "dma_buf" ? camera::BufferMemory::kDmaBuf : camera::BufferMemory::kMapped;
  }
  return camera::V4l2Camera::open(spec.argument, options, clock);
}

Made make_libcamera_camera(const CameraSpec& spec, const Clock& clock) {
  camera::LibcameraOptions options;
  for (const auto& [key, value] : spec.options) {
    TRY_ASSIGN(const bool is_known, read_option(spec, key, value, &options.preferred, &options.exposure));
    if (!is_known)
      return spec.refused("knows the options width_px, height_px, frames_per_second, exposure_ms, colour=yes or no");
  }
  return camera::open_libcamera_camera(spec.argument, options, clock);
}

struct Kind {
  std::string_view name;
  Made (*make)(const CameraSpec& spec, const Clock& clock);
};
constexpr std::array kKinds{Kind{"v4l2", make_v4l2_camera}, Kind{"libcamera", make_libcamera_camera},
                            Kind{"file", make_file_camera}, Kind{"simulated", make_simulated_camera}};

}  // namespace

Made make_camera(std::string_view line, const Clock& clock) {
  const CameraSpec spec = CameraSpec::parse(line);
  std::string known;
  for (const Kind& kind : kKinds) {
    if (kind.name == spec.kind) return kind.make(spec, clock);
    known += fmt::format("{}{}:", known.empty() ? "" : ", ", kind.name);
  }
  return spec.refused(fmt::format("no such kind of camera; the kinds are {}", known));
}

std::vector<camera::ListedCamera> list_cameras() {
  std::vector<camera::ListedCamera> cameras = camera::list_v4l2_cameras();
  for (camera::ListedCamera& camera : camera::list_libcamera_cameras()) cameras.push_back(std::move(camera));
  return cameras;
}

}  // namespace cyclorama::devices

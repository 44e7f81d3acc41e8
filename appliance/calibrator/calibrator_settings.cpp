// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibrator/calibrator_settings.h"

#include <fmt/format.h>

#include <algorithm>

#include "appliance/calibration/camera_file.h"
#include "common/base/address.h"
#include "common/base/text.h"
#include "drivers/camera/camera_settings.h"
#include "drivers/devices/make_turntable.h"

namespace cyclorama::calibrator {
namespace {

using Ranges = CalibratorRanges;
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kMillisecond = 1e-3;

/// Returns the argument for make_camera(). The calibration chooses the exposure itself.
std::string calibration_camera(ConfigTable* camera, const std::string& fallback) {
  if (camera->has("exposure_ms")) {
    camera->refuse("exposure_ms", "is of the tracker's camera; here the calibration chooses the exposure: remove it");
  }
  const std::string line = camera::camera_source(camera, fallback);
  const bool is_kind = std::ranges::any_of(std::initializer_list<std::string_view>{"v4l2:", "libcamera:", "file:"},
                                           [&](std::string_view kind) { return line.starts_with(kind); });
  if (!is_kind && camera->has("source")) {
    camera->refuse("source", "names no camera; write kind = \"v4l2\" and port = \"usb-0000:00:14.0-2\" instead");
  }
  return line;
}

void read_displays(ConfigTable root, CalibratorSettings* ret) {
  for (const std::string& text : root.texts("displays", std::vector<std::string>{})) {
    auto display = scan::parse_pattern_display(text);
    if (display) {
      ret->displays.push_back(*std::move(display));
    } else {
      root.refuse("displays", display.error().message());
    }
  }
}

void read_watched(ConfigTable watch, CalibratorSettings* ret) {
  ret->watch_exposure_s =
      kMillisecond * watch.number("exposure_ms", Ranges::kWatchExposure_ms, ret->watch_exposure_s / kMillisecond);
  ret->watch_hz = watch.number("compare_hz", Ranges::kWatch_hz, ret->watch_hz);
  ret->latency_s = kMillisecond * watch.number("latency_ms", Ranges::kLatency_ms, ret->latency_s / kMillisecond);
  for (ConfigTable camera : watch.tables("camera")) {
    scan::CameraSource plug;
    plug.name = camera.text("name");
    if (camera.has("name") && !scan::is_camera_name(plug.name)) {
      camera.refuse("name", "is no name of a file; use letters, digits, '.', '-' and '_', 60 at most");
    }
    if (!camera.has("kind") && !camera.has("source")) {
      camera.refuse("kind", "is missing: write kind = \"v4l2\" and its port (cyclorama-tracker --list-cameras)");
    }
    plug.spec = calibration_camera(&camera, "");
    const auto is_named = [&](const scan::CameraSource& other) { return other.name == plug.name; };
    const auto is_plugged = [&](const scan::CameraSource& other) {
      return !plug.spec.empty() && other.spec == plug.spec;
    };
    if (std::ranges::any_of(ret->watch, is_named)) camera.refuse("name", "is another camera's too; each has its own");
    if (const auto other = std::ranges::find_if(ret->watch, is_plugged); other != ret->watch.end()) {
      camera.refuse(camera.has("device") ? "device" : "port",
                    fmt::format("is that of camera '{}' too; each has its own", printable(other->name)));
    }
    ret->watch.push_back(std::move(plug));
  }
}

Result<CalibratorSettings> from_config(Config* config, const std::filesystem::path& folder) {
  CalibratorSettings settings;
  ConfigTable root = config->root();
  settings.listen = root.text("listen", settings.listen);
  if (!is_unix_socket(settings.listen)) {
    if (const auto address = parse_address(settings.listen); !address) {
      root.refuse("listen", address.error().message());
    }
  }
  read_displays(root, &settings);
  settings.settle_s = kMillisecond * root.number("settle_ms", Ranges::kSettle_ms, settings.settle_s / kMillisecond);
  root.refuse_renamed("turnplate", "turntable");
  settings.turntable = root.text("turntable", settings.turntable);
  if (const Status turntable = devices::check_turntable(settings.turntable); !turntable) {
    root.refuse("turntable", turntable.error().message());
  }
  ConfigTable camera = root.table("camera");
  settings.camera = calibration_camera(&camera, settings.camera);
  if (const std::string lens = camera.text("lens", ""); !lens.empty()) {
    settings.lens = folder / lens;
    if (camera.has("field_of_view_deg")) camera.refuse("field_of_view_deg", "and lens say the same; remove one");
  }
  settings.field_of_view_rad =
      kDegree * camera.number("field_of_view_deg", Ranges::kFieldOfView_deg, settings.field_of_view_rad / kDegree);
  settings.pitch_rad = kDegree * camera.number("pitch_deg", Ranges::kPitch_deg, settings.pitch_rad / kDegree);
  camera.refuse_renamed("longest_exposure_ms", "max_exposure_ms");
  settings.max_exposure_s =
      kMillisecond * camera.number("max_exposure_ms", Ranges::kMaxExposure_ms, settings.max_exposure_s / kMillisecond);
  read_watched(root.table("watch"), &settings);
  settings.lenses = folder / "cameras";
  TRY(config->finish());
  return settings;
}

Status check_lens(const std::filesystem::path& path, const std::string& whose, bool is_required) {
  auto lens = calibration::read_camera(path);
  if (lens || (!is_required && lens.error().code() == ErrorCode::kNotFound)) return Done{};
  return std::move(lens).error().while_doing("reading the lens of " + whose);
}

}  // namespace

Result<CalibratorSettings> CalibratorSettings::read(const std::filesystem::path& path) {
  TRY_ASSIGN(Config config, Config::read(path));
  return from_config(&config, path.parent_path());
}

Result<CalibratorSettings> CalibratorSettings::parse(std::string_view text, std::string name) {
  TRY_ASSIGN(Config config, Config::parse(text, std::move(name)));
  return from_config(&config, {});
}

Status CalibratorSettings::check_lenses() const {
  if (!lens.empty()) TRY(check_lens(lens, "the camera on the turntable", true));
  for (const scan::CameraSource& fixed : watch) {
    if (lenses.empty()) break;
    TRY(check_lens(lenses / (fixed.name + ".json"), fmt::format("camera '{}'", fixed.name), false));
  }
  return Done{};
}

}  // namespace cyclorama::calibrator

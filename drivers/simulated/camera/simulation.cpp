// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/camera/simulation.h"

#include <algorithm>
#include <limits>
#include <numbers>

#include "common/config/config.h"

namespace cyclorama::simulated {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
/// The family tag36h11 has 587 tags.
constexpr double kLastTagId = 586;

void read_camera(ConfigTable camera, Simulation* ret) {
  const int width = camera.integer("width_px", {1, 8192}, ret->lens.width_px);
  const int height = camera.integer("height_px", {1, 8192}, ret->lens.height_px);
  ret->lens = Pinhole::from_field_of_view(width, height, camera.number("field_of_view_deg", {1, 170}, 60.0) * kDegree);
  ret->frames_per_second = camera.number("frames_per_second", {0.1, 1000}, ret->frames_per_second);
  ret->exposure_s = 1e-3 * camera.number("exposure_ms", {0, 1000}, 1e3 * ret->exposure_s);
  ret->exposure_steps = camera.integer("exposure_steps", {1, 8}, ret->exposure_steps);
  if ((ret->exposure_steps & (ret->exposure_steps - 1)) != 0) camera.refuse("exposure_steps", "must be 1, 2, 4 or 8");
  ret->noise_grey = camera.number("noise_grey", {0, 100}, ret->noise_grey);
  ret->brightness = camera.number("brightness", {0, 10}, ret->brightness);
  ret->seed = static_cast<std::uint32_t>(camera.integer("seed", {0, std::numeric_limits<int>::max()}, 1));
  if (ret->exposure_s * ret->frames_per_second > 1.0) {
    camera.refuse("exposure_ms", "is longer than the time between two frames; shorten it or lower frames_per_second");
  }
}

void read_backdrop(ConfigTable backdrop, Simulation* ret) {
  const std::string kind = backdrop.choice("kind", {"plain", "gradient", "clutter"}, "clutter");
  ret->backdrop = kind == "plain" ? Backdrop::kPlain : kind == "gradient" ? Backdrop::kGradient : Backdrop::kClutter;
  ret->backdrop_grey = backdrop.number("grey", {0, 255}, ret->backdrop_grey);
}

/// Reads [tag]: a flat tag instead of a wand.
void read_pattern(ConfigTable root, Simulation* ret) {
  const bool has_wand = root.has("wand");
  const bool has_tag = root.has("tag");
  const int number = root.table("wand").integer("number", {0, kStandardWands - 1}, 0);
  ret->wand = standard_wand(number);
  if (!has_tag) return;
  if (has_wand) root.refuse("wand", "and [tag] say what the hand holds; remove one");
  ConfigTable tag = root.table("tag");
  const int id = tag.integer("id", {0, kLastTagId}, 0);
  ret->wand = flat_tag(id, 1e-3 * tag.number("size_mm", {1, 10000}, 120.0));
}

void read_path(ConfigTable path, Simulation* ret) {
  std::vector<KeyPose> keys;
  for (ConfigTable table : path.tables("key")) {
    KeyPose key;
    key.time_s = table.number("time_s", {0, 86400});
    const std::vector<double> position = table.numbers("position_m", 3, {-100, 100});
    if (position.size() == 3) std::copy(position.begin(), position.end(), key.position_m.data());
    key.yaw_rad = table.number("yaw_deg", {-3600, 3600}, 0.0) * kDegree;
    key.pitch_rad = table.number("pitch_deg", {-3600, 3600}, 0.0) * kDegree;
    key.roll_rad = table.number("roll_deg", {-3600, 3600}, 0.0) * kDegree;
    keys.push_back(key);
  }
  std::optional<double> loop_s;
  if (path.has("loop_s")) loop_s = path.number("loop_s", {0, 86400});
  if (keys.empty()) {
    // Without keys the demo's movement is used. A loop without keys is refused, since it would have no effect.
    if (loop_s) path.refuse("loop_s", "needs key poses: add [[path.key]] tables");
    return;
  }
  auto made = HandPath::make(std::move(keys), loop_s);
  if (!made) {
    path.refuse("key", made.error().message());
    return;
  }
  ret->path = *std::move(made);
}

Result<Simulation> from_config(Config* config) {
  Simulation simulation;
  ConfigTable root = config->root();
  read_camera(root.table("camera"), &simulation);
  read_backdrop(root.table("backdrop"), &simulation);
  read_pattern(root, &simulation);
  read_path(root.table("path"), &simulation);
  TRY(config->finish());
  return simulation;
}

}  // namespace

Result<Simulation> Simulation::read(const std::filesystem::path& path) {
  TRY_ASSIGN(Config config, Config::read(path));
  return from_config(&config);
}

Result<Simulation> Simulation::parse(std::string_view text, std::string name) {
  TRY_ASSIGN(Config config, Config::parse(text, std::move(name)));
  return from_config(&config);
}

}  // namespace cyclorama::simulated

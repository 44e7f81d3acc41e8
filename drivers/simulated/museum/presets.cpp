// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/presets.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/file.h"
#include "drivers/simulated/museum/flaws.h"

namespace cyclorama::simulated {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kRadius_m = 4.3;
constexpr double kArc_rad = 126.0 * kDegree;
constexpr double kBottom_m = 0.6;
constexpr double kTop_m = 2.6;
constexpr double kEye_m = 1.6;

/// Division of the lit width among projectors.
struct Share {
  double width;  ///< Width of one picture.
  double step;   ///< Distance from one picture to the next.
};
Share shares(double whole, int count, double overlap) {
  const double width = whole / (count - (count - 1) * overlap);
  return {width, width * (1.0 - overlap)};
}

std::string projector_text(int index, const PresetOptions& options, double fov_rad, const Eigen::Vector3d& position,
                           double pan_rad, double tilt_rad, double shift_down) {
  return fmt::format(
      "[[projector]]\nname = \"projector {}\"\nwidth_px = {}\nheight_px = {}\nfield_of_view_deg = {:.6f}\n"
      "position_m = [{:.6f}, {:.6f}, {:.6f}]\npan_deg = {:.6f}\ntilt_deg = {:.6f}\nlens_shift_fraction = [0, {:.6f}]\n",
      index + 1, options.projector_width_px, options.projector_height_px, fov_rad / kDegree, position.x(), position.y(),
      position.z(), pan_rad / kDegree, tilt_rad / kDegree, shift_down);
}

std::string head_text(std::string_view name, std::string_view wall) {
  return fmt::format("name = \"{}\"\n[wall]\n{}[visitor]\neye_m = [0, {}, 0]\n", name, wall, kEye_m);
}

/// Returns projectors above the visitor that face outwards, each set back from the centre along its axis.
std::string around(const PresetOptions& options, double radius_m, double arc_rad, double behind_m) {
  const Share share = shares(arc_rad, options.projectors, options.overlap);
  const double half = 0.5 * share.width;
  constexpr double kMargin = 1.04;
  const double fov = 2.0 * std::atan(kMargin * radius_m * std::sin(half) / (radius_m * std::cos(half) + behind_m));
  const double height = kTop_m + 0.1;
  const double tilt = -std::atan2(height - 0.5 * (kTop_m + kBottom_m), radius_m + behind_m);
  std::string text;
  for (int i = 0; i < options.projectors; ++i) {
    const double pan = (i - 0.5 * (options.projectors - 1)) * share.step;
    const Eigen::Vector3d position(-behind_m * std::sin(pan), height, behind_m * std::cos(pan));
    text += projector_text(i, options, fov, position, pan, tilt, 0.0);
  }
  return text;
}

std::string cylinder_text(std::string_view name, const PresetOptions& options) {
  return head_text(name, fmt::format("radius_m = {}\narc_deg = {}\nbottom_m = {}\ntop_m = {}\n", kRadius_m,
                                     kArc_rad / kDegree, kBottom_m, kTop_m)) +
         around(options, kRadius_m, kArc_rad, 0.5);
}

std::string plane_text(const PresetOptions& options) {
  constexpr double kWidth_m = 8.0;
  constexpr double kAway_m = 4.0;
  constexpr double kThrow_m = 3.4;
  std::string text =
      head_text("plane", fmt::format("shape = \"plane\"\ncentre_m = [0, {}, {}]\nwidth_m = {}\n"
                                     "height_m = {}\n",
                                     0.5 * (kTop_m + kBottom_m), -kAway_m, kWidth_m, kTop_m - kBottom_m));
  const Share share = shares(kWidth_m, options.projectors, options.overlap);
  const double fov = 2.0 * std::atan(0.52 * share.width / kThrow_m);
  const double focal_per_height = 0.5 * options.projector_width_px / std::tan(0.5 * fov) / options.projector_height_px;
  for (int i = 0; i < options.projectors; ++i) {
    // The projectors are level and above the picture, and shift it downwards: there is no keystone, as installers
    // prefer.
    const double x = (i - 0.5 * (options.projectors - 1)) * share.step;
    const double drop = kTop_m + 0.1 - 0.5 * (kTop_m + kBottom_m);
    text += projector_text(i, options, fov, {x, kTop_m + 0.1, kThrow_m - kAway_m}, 0.0, 0.0,
                           -std::min(focal_per_height * drop / kThrow_m, 0.7));
  }
  return text;
}

std::string corner_text(const PresetOptions& options, double half_angle_rad) {
  constexpr double kSide_m = 4.0;
  constexpr double kAway_m = 4.2;
  const double x = kSide_m * std::sin(half_angle_rad);
  const double z = -kAway_m + kSide_m * std::cos(half_angle_rad);
  const std::string wall = fmt::format(
      "shape = \"planes\"\ncorners_m = [[{:.6f}, {:.6f}], [0, {}], [{:.6f}, {:.6f}]]\nbottom_m = {}\ntop_m = {}\n", -x,
      z, -kAway_m, x, z, kBottom_m + 0.2, kTop_m - 0.2);
  // The field covers the wall up to its left and right ends.
  return head_text("corner", wall) + around(options, 0.5 * (kAway_m + std::hypot(x, z)), 2.0 * std::atan2(x, -z), 0.6);
}

std::string dome_text(const PresetOptions& options) {
  constexpr double kDome_m = 4.0;
  constexpr double kField_deg = 90.0;
  constexpr double kTilt_deg = 25.0;
  std::string text = head_text("dome", fmt::format("shape = \"dome\"\ncentre_m = [0, {}, 0]\nradius_m = {}\n"
                                                   "field_deg = {}\ntilt_deg = {}\n",
                                                   kEye_m, kDome_m, kField_deg, kTilt_deg));
  const double field = kField_deg * kDegree;
  const Share share = shares(field, options.projectors, options.overlap);
  const double behind = 0.8;
  const double half =
      std::max(0.5 * share.width, 0.5 * field * options.projector_width_px / options.projector_height_px * 0.7);
  const double fov = 2.0 * std::atan(kDome_m * std::sin(half) / (kDome_m * std::cos(half) + behind));
  for (int i = 0; i < options.projectors; ++i) {
    const double pan = (i - 0.5 * (options.projectors - 1)) * share.step;
    text += projector_text(i, options, fov, {-behind * std::sin(pan), kEye_m - 0.5, behind * std::cos(pan)}, pan,
                           (kTilt_deg + 5.0) * kDegree, 0.0);
  }
  return text;
}

Pinhole camera_of(std::string_view name, const PresetOptions& options) {
  const bool is_dome = name == "dome";
  const double aspect = is_dome ? 1.0 : 4.0 / 3.0;
  const int height = std::max(16, static_cast<int>(std::lround(std::sqrt(1e6 * options.camera_megapixels / aspect))));
  const int width = static_cast<int>(std::lround(height * aspect));
  return Pinhole::from_field_of_view(width, height, (is_dome ? 92.0 : 70.0) * kDegree);
}

}  // namespace

const std::vector<std::string>& preset_names() {
  static const std::vector<std::string> names{"cylinder126", "not-quite-cylinder", "tilted", "bumpy", "plane", "corner",
                                              "dome"};
  return names;
}

Result<Preset> make_preset(std::string_view name, std::uint32_t seed, const PresetOptions& options) {
  if (options.projectors < 1 || options.projectors > 16 || !(options.overlap >= 0.0 && options.overlap < 0.9) ||
      !(options.camera_megapixels > 0.0 && options.camera_megapixels <= 64.0)) {
    return Error(ErrorCode::kInvalidArgument,
                 "a preset has 1 to 16 projectors, an overlap from 0 to 0.9 and a camera of at most 64 megapixels");
  }
  // Each kind of flaw draws from its own stream, so that an additional flaw does not change the others.
  RandomStream draws(seed);
  Preset preset;
  const bool is_corner = name == "corner";
  const double half_corner = is_corner ? 0.5 * draws.stream("corner").between(90.0, 130.0) * kDegree : 0.0;
  if (std::ranges::find(preset_names(), name) == preset_names().end()) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("no museum is called '{}'; there are {}", name, fmt::join(preset_names(), ", ")));
  }
  preset.installation_text = is_corner         ? corner_text(options, half_corner)
                             : name == "plane" ? plane_text(options)
                             : name == "dome"  ? dome_text(options)
                                               : cylinder_text(name, options);
  TRY_ASSIGN(preset.installation, parse_installation(preset.installation_text, std::string(name)));
  preset.truth = MuseumTruth::ideal(preset.installation);
  preset.truth.seed = seed;
  preset.truth.camera.lens = TrueLens(camera_of(name, options));
  if (name == "dome") {
    const Eigen::Quaterniond ahead_and_up(
        Eigen::AngleAxisd(std::numbers::pi + 25.0 * kDegree, Eigen::Vector3d::UnitX()));
    preset.truth.turntable.T_turntable_camera = {ahead_and_up, Eigen::Vector3d::Zero()};
  }
  if (name == "not-quite-cylinder") bend_wall(draws.stream("profile"), 4.06, 4.6, &preset.truth);
  if (name == "tilted") tilt_wall(draws.stream("tilt"), &preset.truth);
  if (name == "bumpy") dent_wall(draws.stream("bumps"), &preset.truth);
  if (options.has_flaws) add_flaws(draws, &preset.truth);
  return preset;
}

Status write_preset(const Preset& preset, const std::filesystem::path& folder) {
  const std::filesystem::path installation = folder / "installation.toml";
  TRY(write_file_atomically(installation, preset.installation_text));
  return write_file_atomically(truth_path_beside(installation), preset.truth.text());
}

}  // namespace cyclorama::simulated

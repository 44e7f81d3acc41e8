// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/truth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/file.h"
#include "common/config/config.h"
#include "common/room/read_wall.h"

namespace cyclorama::simulated {
namespace {

constexpr double kMany = 1e6;
constexpr Range kSmall{-10.0, 10.0};
constexpr Range kMetres{-100.0, 100.0};
constexpr Range kNotNegative{0.0, kMany};

RoomColour colour_of(ConfigTable* table, const char* key, Range range, const RoomColour& fallback) {
  const auto read = table->numbers(key, 3, range, std::vector<double>(fallback.begin(), fallback.end()));
  return read.size() == 3 ? RoomColour{read[0], read[1], read[2]} : fallback;
}

ColourMatrix matrix_of(ConfigTable* table, const char* key, const ColourMatrix& fallback) {
  if (!table->has(key)) return fallback;
  const auto rows = table->points(key, 3, kSmall);
  if (rows.size() != 3) {
    table->refuse(key, "must be three rows of three numbers");
    return fallback;
  }
  ColourMatrix matrix{};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) matrix[r][c] = rows[r][c];
  }
  return matrix;
}

template <typename To, typename From>
RigidTransform<To, From> transform_of(ConfigTable table) {
  const auto q = table.numbers("rotation_wxyz", 4, {-1.0, 1.0}, std::vector<double>{1.0, 0.0, 0.0, 0.0});
  const auto t = table.numbers("translation_m", 3, kMetres, std::vector<double>{0.0, 0.0, 0.0});
  if (q.size() != 4 || t.size() != 3) return {};
  const Eigen::Quaterniond rotation(q[0], q[1], q[2], q[3]);
  if (!(rotation.norm() > 0.5)) {
    table.refuse("rotation_wxyz", "must be a unit quaternion");
    return {};
  }
  return {rotation, {t[0], t[1], t[2]}};
}

TrueResponse curve_of(ConfigTable table) {
  TrueResponse curve;
  curve.gamma = table.number("gamma", {0.1, 10.0}, curve.gamma);
  curve.bend = table.number("bend", {-1.0, 1.0}, curve.bend);
  curve.clip = table.number("clip", {0.1, 1.0}, curve.clip);
  curve.dip = table.number("dip", {0.0, 1.0}, curve.dip);
  return curve;
}

std::vector<LensWave> waves_of(ConfigTable* table) {
  std::vector<LensWave> waves;
  for (ConfigTable& wave : table->tables("wave")) {
    const auto shift = wave.numbers("shift_px", 2, {-100.0, 100.0});
    const auto slope = wave.numbers("rad_per_px", 2, {-10.0, 10.0});
    const double phase = wave.number("phase_rad", {-10.0, 10.0}, 0.0);
    if (shift.size() == 2 && slope.size() == 2) waves.push_back({{shift[0], shift[1]}, {slope[0], slope[1]}, phase});
  }
  return waves;
}

TrueLens lens_of(ConfigTable table) {
  Pinhole pinhole;
  pinhole.width_px = table.integer("width_px", {1, 16384});
  pinhole.height_px = table.integer("height_px", {1, 16384});
  pinhole.focal_px = table.number("focal_px", {1.0, kMany});
  const auto centre = table.numbers("centre_px", 2, {-kMany, kMany});
  if (centre.size() == 2) {
    pinhole.centre_u_px = centre[0];
    pinhole.centre_v_px = centre[1];
  }
  const auto k = table.numbers("radial", 3, kSmall, std::vector<double>(3, 0.0));
  const auto p = table.numbers("tangential", 2, {-1.0, 1.0}, std::vector<double>(2, 0.0));
  const std::vector<LensWave> waves = waves_of(&table);
  if (k.size() != 3 || p.size() != 2) return TrueLens(pinhole);
  return TrueLens(pinhole, {k[0], k[1], k[2]}, {p[0], p[1]}, waves);
}

WallPaint paint_of(ConfigTable table) {
  constexpr Range kPart{0.0, 1.0};
  WallPaint paint;
  for (ConfigTable& seam : table.tables("seam"))
    paint.seams.push_back(
        {seam.number("across", kPart), seam.number("width", {1e-5, 1.0}), seam.number("albedo", kPart)});
  for (ConfigTable& panel : table.tables("panel")) {
    paint.panels.push_back({panel.number("left", kPart), panel.number("right", kPart), panel.number("low", kPart),
                            panel.number("high", kPart), panel.number("albedo", kPart),
                            panel.number("gloss", kNotNegative, 0.0)});
  }
  paint.plaster = table.number("plaster", {0.0, 0.5}, paint.plaster);
  paint.plaster_grain_m = table.number("plaster_grain_m", {1e-4, 1.0}, paint.plaster_grain_m);
  paint.sheen = table.number("sheen", {0.0, 10.0}, paint.sheen);
  paint.sheen_exponent = table.number("sheen_exponent", {1.0, 1e4}, paint.sheen_exponent);
  return paint;
}

CameraPipeline pipeline_of(ConfigTable table) {
  CameraPipeline pipeline;
  pipeline.noise_reduction = table.number("noise_reduction", {0.0, 1.0}, 0.0);
  pipeline.sharpening = table.number("sharpening", {0.0, 10.0}, 0.0);
  pipeline.jpeg_quality = table.integer("jpeg_quality", {0, 100}, 0);
  pipeline.auto_exposure = table.number("auto_exposure", {0.0, 1.0}, 0.0);
  return pipeline;
}

WallDeviation deviation_of(ConfigTable table) {
  WallDeviation deviation;
  for (ConfigTable& wave : table.tables("wave")) {
    deviation.waves.push_back({wave.number("height_m", {-1.0, 1.0}), wave.number("s_rad_per_m", {-100.0, 100.0}),
                               wave.number("t_rad_per_m", {-100.0, 100.0}),
                               wave.number("phase_rad", {-10.0, 10.0}, 0.0)});
  }
  for (ConfigTable& bump : table.tables("bump")) {
    deviation.bumps.push_back({bump.number("height_m", {-1.0, 1.0}), bump.number("s_m", kMetres),
                               bump.number("t_m", kMetres), bump.number("sigma_m", {0.01, 100.0})});
  }
  return deviation;
}

TrueProjector projector_of(ConfigTable table) {
  TrueProjector p;
  p.lens = lens_of(table.table("lens"));
  p.T_room_projector = transform_of<frame::Room, frame::Projector>(table.table("pose"));
  p.flux_lm = table.number("flux_lm", kNotNegative, p.flux_lm);
  p.vignetting_exponent = table.number("vignetting_exponent", {0.0, 100.0}, p.vignetting_exponent);
  p.response = {curve_of(table.table("red")), curve_of(table.table("green")), curve_of(table.table("blue"))};
  p.primaries = matrix_of(&table, "primaries", p.primaries);
  p.black = colour_of(&table, "black", {0.0, 1.0}, p.black);
  p.blur_px = table.number("blur_px", {0.0, 20.0}, p.blur_px);
  p.focus_distance_m = table.number("focus_distance_m", {0.01, kMany}, p.focus_distance_m);
  p.defocus_px_per_dioptre = table.number("defocus_px_per_dioptre", {0.0, 1000.0}, p.defocus_px_per_dioptre);
  p.latency_s = table.number("latency_s", {0.0, 10.0}, p.latency_s);
  const auto colour = table.numbers("lateral_colour", 2, {-0.1, 0.1}, std::vector<double>(2, 0.0));
  if (colour.size() == 2) p.lateral_colour = {colour[0], colour[1]};
  p.white_segment = table.number("white_segment", {0.0, 10.0}, p.white_segment);
  const auto drift = table.numbers("drift_px", 2, {-100.0, 100.0}, std::vector<double>(2, 0.0));
  if (drift.size() == 2) p.drift_px = {drift[0], drift[1]};
  p.warm_up_s = table.number("warm_up_s", {1.0, kMany}, p.warm_up_s);
  return p;
}

TrueCamera camera_of(ConfigTable table) {
  TrueCamera c;
  c.lens = lens_of(table.table("lens"));
  c.vignetting_exponent = table.number("vignetting_exponent", {0.0, 100.0}, c.vignetting_exponent);
  c.sensitivity = matrix_of(&table, "sensitivity", c.sensitivity);
  c.grey_sensitivity = colour_of(&table, "grey_sensitivity", kSmall, c.grey_sensitivity);
  c.electrons_per_nit_s = table.number("electrons_per_nit_s", kNotNegative, c.electrons_per_nit_s);
  c.full_well_e = table.number("full_well_e", {1.0, 1e9}, c.full_well_e);
  c.read_noise_e = table.number("read_noise_e", kNotNegative, c.read_noise_e);
  c.has_shot_noise = table.flag("has_shot_noise", c.has_shot_noise);
  c.bits = table.integer("bits", {8, 16}, c.bits);
  c.response = curve_of(table.table("response"));
  c.pedestal = table.number("pedestal", {0.0, 0.5}, c.pedestal);
  c.blur_px = table.number("blur_px", {0.0, 20.0}, c.blur_px);
  c.line_time_s = table.number("line_time_s", {0.0, 1.0}, c.line_time_s);
  c.pipeline = pipeline_of(table.table("pipeline"));
  return c;
}

TrueTurntable turntable_of(ConfigTable table) {
  TrueTurntable turntable;
  turntable.T_room_turntable = transform_of<frame::Room, frame::Turntable>(table.table("axis"));
  turntable.T_turntable_camera = transform_of<frame::Turntable, frame::Camera>(table.table("camera"));
  turntable.scale_error = table.number("scale_error", {-0.5, 0.5}, turntable.scale_error);
  turntable.wobble_rad = table.number("wobble_rad", {-1.0, 1.0}, turntable.wobble_rad);
  turntable.backlash_rad = table.number("backlash_rad", {0.0, 1.0}, turntable.backlash_rad);
  turntable.jitter_rad = table.number("jitter_rad", {0.0, 1.0}, turntable.jitter_rad);
  turntable.speed_rad_s = table.number("speed_rad_s", {1e-3, 1e3}, turntable.speed_rad_s);
  const auto creep = table.numbers("creep_px_per_h", 2, {-1e3, 1e3}, std::vector<double>(2, 0.0));
  if (creep.size() == 2) turntable.creep_px_per_h = {creep[0], creep[1]};
  turntable.vibration_px = table.number("vibration_px", {0.0, 100.0}, turntable.vibration_px);
  return turntable;
}

}  // namespace

Eigen::Vector2d TrueProjector::drift_at(double now_s) const {
  return (1.0 - std::exp(-std::max(now_s, 0.0) / warm_up_s)) * drift_px;
}

RoomColour MuseumTruth::ambient_at(double now_s) const {
  const double share = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * now_s / daylight_period_s);
  RoomColour lux = ambient_lux;
  for (std::size_t r = 0; r < 3; ++r) lux[r] += share * daylight_lux[r];
  return lux;
}

MuseumTruth MuseumTruth::warmed_up(double now_s) const {
  MuseumTruth truth = *this;
  for (TrueProjector& projector : truth.projectors) {
    const Eigen::Vector2d drift = projector.drift_at(now_s);
    Pinhole pinhole = projector.lens.pinhole();
    pinhole.centre_u_px += drift.x();
    pinhole.centre_v_px += drift.y();
    projector.lens = TrueLens(pinhole, projector.lens.radial(), projector.lens.tangential(), projector.lens.waves());
    projector.drift_px.setZero();
  }
  return truth;
}

MuseumTruth MuseumTruth::ideal(const Installation& installation) {
  MuseumTruth truth;
  truth.wall = installation.wall;
  for (const InstalledProjector& installed : installation.projectors) {
    TrueProjector projector;
    projector.lens = TrueLens(installed.lens);
    projector.T_room_projector = installed.T_room_projector;
    truth.projectors.push_back(projector);
  }
  truth.camera.lens = TrueLens(Pinhole::from_field_of_view(1200, 900, 70.0 * std::numbers::pi / 180.0));
  truth.turntable.T_room_turntable = {Eigen::Quaterniond::Identity(), installation.sweet_spot.xyz};
  const Eigen::Quaterniond looking_ahead(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
  truth.turntable.T_turntable_camera = {looking_ahead, Eigen::Vector3d::Zero()};
  return truth;
}

Result<MuseumTruth> MuseumTruth::parse(std::string_view text, std::string name, const std::filesystem::path& folder) {
  TRY_ASSIGN(Config config, Config::parse(text, std::move(name)));
  ConfigTable root = config.root();
  MuseumTruth truth;
  if (const auto wall = read_wall(root.table("wall"), folder)) truth.wall = *wall;
  truth.T_room_wall = transform_of<frame::Room, frame::Room>(root.table("wall_pose"));
  truth.deviation = deviation_of(root.table("deviation"));
  truth.albedo = colour_of(&root, "albedo", {0.0, 0.99}, truth.albedo);
  truth.ambient_lux = colour_of(&root, "ambient_lux", kNotNegative, truth.ambient_lux);
  truth.paint = paint_of(root.table("paint"));
  truth.daylight_lux = colour_of(&root, "daylight_lux", kNotNegative, truth.daylight_lux);
  truth.daylight_period_s = root.number("daylight_period_s", {1.0, kMany}, truth.daylight_period_s);
  truth.surround_nits = root.number("surround_nits", kNotNegative, truth.surround_nits);
  truth.cells = root.integer("cells", {0, 4000}, truth.cells);
  truth.seed = static_cast<std::uint32_t>(root.integer("seed", {0, std::numeric_limits<int>::max()}, 1));
  for (ConfigTable& table : root.tables("projector")) truth.projectors.push_back(projector_of(table));
  truth.camera = camera_of(root.table("camera"));
  truth.turntable = turntable_of(root.table("turntable"));
  TRY(config.finish());
  return truth;
}

Result<MuseumTruth> MuseumTruth::read(const std::filesystem::path& path) {
  TRY_ASSIGN(const std::string text, read_text_file(path, std::size_t{1} << 20));
  return parse(text, path.string(), path.parent_path());
}

std::filesystem::path truth_path_beside(const std::filesystem::path& installation) {
  return installation.parent_path() / "truth.toml";
}

}  // namespace cyclorama::simulated

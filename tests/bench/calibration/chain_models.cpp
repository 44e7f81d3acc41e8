// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/calibration/chain_models.h"

#include <fmt/format.h>

#include <ctime>
#include <optional>
#include <vector>

#include "appliance/calibration/map_grid.h"
#include "appliance/scan/simulated_devices.h"
#include "appliance/solve/calibrate.h"
#include "appliance/solve/surface_fit.h"
#include "drivers/simulated/turntable/simulated_turntable.h"

namespace cyclorama {
namespace {

using Json = nlohmann::ordered_json;

double cpu_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Returns the samples to which a wall is fitted: every third control point of the maps with a small enough sigma.
std::vector<solve::MapSample> samples_of(const std::vector<calibration::CalibratedProjector>& projectors) {
  constexpr int kEvery = 3;
  constexpr double kSure_px = 0.2;
  std::vector<solve::MapSample> samples;
  for (std::size_t p = 0; p < projectors.size(); ++p) {
    const calibration::MeasuredMap& map = projectors[p].map;
    const calibration::MapGrid grid{map.width_px, map.height_px, map.cells_x, map.cells_y};
    for (int y = 0; y <= map.cells_y; y += kEvery) {
      for (int x = 0; x <= map.cells_x; x += kEvery) {
        const auto node = static_cast<std::size_t>(grid.node(x, y));
        if (!map.directions[node].allFinite() || !(map.sigma_px[node] < kSure_px)) continue;
        samples.push_back({{x * grid.cell_width(), y * grid.cell_height()}, map.directions[node], 0.05, p});
      }
    }
  }
  return samples;
}

std::optional<Eigen::Vector2d> pixel_of(const calibration::SurfaceFit& fit, std::size_t p,
                                        const Eigen::Vector3d& direction) {
  const auto inverse_depth = fit.surface.inverse_depth_at(direction);
  const auto& T_eye_projector = fit.projectors[p].T_eye_projector;
  if (!inverse_depth) return std::nullopt;
  return fit.projectors[p].lens.pixel_of(T_eye_projector.rotation().conjugate() *
                                         (direction - *inverse_depth * T_eye_projector.translation()));
}

/// Direction of a pixel by the model: the map's direction, moved until the model predicts that pixel.
std::optional<Eigen::Vector3d> direction_by(const calibration::SurfaceFit& fit, const calibration::MeasuredMap& map,
                                            std::size_t p, const Eigen::Vector2d& pixel) {
  constexpr double kBeside_px = 0.5;
  constexpr int kSteps = 6;
  const auto start = map.direction_at(pixel);
  if (!start) return std::nullopt;
  Eigen::Vector3d direction = *start;
  const Eigen::Vector3d right = direction.cross(Eigen::Vector3d::UnitY()).normalized();
  const Eigen::Vector3d up = right.cross(direction);
  for (int step = 0; step < kSteps; ++step) {
    const auto here = pixel_of(fit, p, direction);
    if (!here) return std::nullopt;
    Eigen::Matrix2d slope;
    constexpr double kStep_rad = 1e-4;
    const auto aside = pixel_of(fit, p, (direction + kStep_rad * right).normalized());
    const auto above = pixel_of(fit, p, (direction + kStep_rad * up).normalized());
    if (!aside || !above) return std::nullopt;
    slope << (*aside - *here) / kStep_rad, (*above - *here) / kStep_rad;
    if (!(std::abs(slope.determinant()) > kBeside_px)) return std::nullopt;
    const Eigen::Vector2d move = slope.inverse() * (pixel - *here);
    direction = (direction + move.x() * right + move.y() * up).normalized();
  }
  return direction;
}

/// Fits every model from the plane upwards, each from its best starting model.
std::vector<Result<calibration::SurfaceFit>> climb(const std::vector<solve::MeasuredProjector>& projectors,
                                                   const std::vector<solve::MapSample>& samples,
                                                   const calibration::SurfaceFit& first) {
  constexpr double kKnot_rad = 0.1;
  std::vector<Eigen::Vector3d> spread;
  for (const solve::MapSample& sample : samples) spread.push_back(sample.direction);
  std::vector<Result<calibration::SurfaceFit>> fits;
  calibration::SurfaceFit from = first;
  for (const calibration::SurfaceModel model : calibration::kSurfaceModels) {
    calibration::SurfaceFit start = from;
    start.surface = calibration::Surface::start(model, from.surface, spread, kKnot_rad);
    if (model == calibration::SurfaceModel::kCylinder) {
      start = first;
      start.surface = calibration::Surface::start(model, first.surface, spread, kKnot_rad);
      start.surface.parameters[3] = 1.0 / first.surface.distance_m;
    }
    fits.push_back(solve::fit_surface(projectors, samples, start, {calibration::LensModel::kDecentred, false, 50}));
    if (fits.back() && model == calibration::SurfaceModel::kCylinder) from = *fits.back();
  }
  return fits;
}

}  // namespace

Json model_points(const ChainCase& chain, const std::filesystem::path& folder) {
  const auto failed = [](const Error& error) { return Json{{"why", error.message()}}; };
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
  std::filesystem::create_directories(folder, ignored);
  const auto preset = simulated::make_preset(chain.name, chain.seed, chain.museum);
  if (!preset) return failed(preset.error());
  auto museum = simulated::SimulatedMuseum::make(preset->installation, preset->truth);
  if (!museum) return failed(museum.error());
  scan::SimulatedPatternScreen screen(&*museum);
  scan::SimulatedScanCamera camera(&*museum, scan::PhotographColour::kGrey);
  simulated::SimulatedTurntable turntable(&*museum);
  const KnownCamera known = camera_of_preset(chain.name);
  scan::ScanSettings settings;
  settings.camera = scan::data_sheet_lens(camera.width_px(), camera.height_px(), known.field_of_view_rad);
  settings.pitch_rad = known.pitch_rad;
  settings.view = chain.view;
  const double begun_s = museum->now_s();
  const auto scan =
      scan::scan_wall(museum->installation(), settings, {screen, camera, turntable}, folder / "scan", {}, {});
  if (!scan) return failed(scan.error());
  solve::CalibrateOptions options;
  options.with_wall = false;
  const double solve_begun_s = cpu_s();
  const auto calibration = solve::calibrate(scan->measurements, "2026-01-01T00-00-00Z", options);
  if (!calibration) return failed(calibration.error());
  const double museum_s = museum->now_s() - begun_s;
  const auto& projectors = calibration->projectors;
  Json models = Json::array();
  const auto add = [&](const std::string& value, bool is_default, double solve_s, const DirectionOfPixel& mapped) {
    const MuseumScore score = museum_score(museum->truth(), mapped);
    models.push_back({{"value", value},
                      {"default", is_default},
                      {"mean_px", score.mean_px},
                      {"p95_px", score.p95_px},
                      {"max_px", score.max_px},
                      {"true_p95_px", score.true_p95_px},
                      {"missing", static_cast<double>(score.missing) / static_cast<double>(score.lit)},
                      {"pictures", scan->pictures},
                      {"museum_s", museum_s},
                      {"solve_s", solve_s}});
  };
  add("none", true, cpu_s() - solve_begun_s,
      [&](std::size_t p, const Eigen::Vector2d& pixel) { return projectors[p].map.direction_at(pixel); });
  const auto add_fit = [&](const std::string& value, const calibration::SurfaceFit& fit, double solve_s) {
    add(value, false, solve_s,
        [&](std::size_t p, const Eigen::Vector2d& pixel) { return direction_by(fit, projectors[p].map, p, pixel); });
  };
  const std::vector<solve::MapSample> samples = samples_of(projectors);
  const auto& measured = scan->measurements.projectors;
  const auto first = solve::surface_start(measured, samples, scan->measurements.wall_distance_m);
  if (!first) return failed(first.error());
  const double climb_begun_s = cpu_s();
  const auto fits = climb(measured, samples, *first);
  const double climb_s = cpu_s() - climb_begun_s;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    const std::string name(name_of(calibration::kSurfaceModels[i]));
    if (!fits[i]) continue;
    add_fit(name, *fits[i], climb_s);
    if (calibration::kSurfaceModels[i] != calibration::SurfaceModel::kProfile) continue;
    for (const calibration::LensModel lens : solve::kProjectorLensModels) {
      const auto fit = solve::fit_surface(measured, samples, *fits[i], {lens, false, 50});
      if (fit) add_fit(fmt::format("{}, lens {}", name, name_of(lens)), *fit, climb_s);
    }
  }
  std::filesystem::remove_all(folder, ignored);
  return {{"models", models}};
}

}  // namespace cyclorama

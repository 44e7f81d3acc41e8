// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/calibration/chain_seams.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "appliance/calibration/calibration_file.h"
#include "appliance/photometry/light_file.h"
#include "appliance/photometry/reblend.h"
#include "common/base/file.h"

namespace cyclorama {
namespace {

constexpr int kTrueMap_px = 8;
constexpr int kTrueLight_px = 16;
constexpr double kTight = 1e-4;
const Eigen::Vector3d kEye{0.2126, 0.7152, 0.0722};  // ITU-R BT.709.

double luminance(const simulated::RoomColour& colour) {
  return kEye.dot(Eigen::Vector3d(colour[0], colour[1], colour[2]));
}

/// True direct light of a projector, in the unit of the measured light. Excludes interreflections between walls.
photometry::PictureField true_light(const simulated::TrueMuseum& museum, std::size_t projector,
                                    const photometry::PictureField& measured) {
  const double white =
      luminance(museum.colour_of(projector, {255, 255, 255})) - luminance(museum.colour_of(projector, {0, 0, 0}));
  std::vector<photometry::FieldSample> correspondences;
  std::vector<double> logs;
  std::vector<double> units;
  for (int y = 0; y <= measured.height_px; y += kTrueLight_px) {
    for (int x = 0; x <= measured.width_px; x += kTrueLight_px) {
      const auto hit = museum.wall_at(projector, x, y);
      const double lux = hit ? museum.gain_lux(projector, *hit) : 0.0;
      if (!(lux > 0.0)) continue;
      correspondences.push_back({Eigen::Vector2d(x, y), kTight});
      logs.push_back(std::log(lux * white));
      units.push_back(measured.at(correspondences.back().pixel) - logs.back());
    }
  }
  const auto middle = units.begin() + static_cast<std::ptrdiff_t>(units.size() / 2);
  std::nth_element(units.begin(), middle, units.end());
  for (double& log : logs) log += *middle;
  const photometry::FieldFit fit(measured.width_px, measured.height_px, 2 * kTrueLight_px, 1.0, correspondences);
  return fit.fit(Eigen::Map<const Eigen::VectorXd>(logs.data(), static_cast<Eigen::Index>(logs.size())));
}

double percentile(std::vector<double> values, double part) {
  if (values.empty()) return 0.0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

std::string in_percent(const std::vector<double>& values) {
  return fmt::format("{:>7.2f}{:>7.2f}", 100.0 * percentile(values, 0.95), 100.0 * percentile(values, 1.0));
}

void tell(const std::string& name, const photometry::Photometry& light, const SeamScore& score, std::string* csv) {
  std::vector<double> steps;
  std::vector<double> jumps;
  std::vector<double> slopes;
  for (const SeamScore::Border& border : score.borders) {
    steps.push_back(std::abs(border.step));
    jumps.push_back(std::abs(border.jump));
    slopes.push_back(std::max(std::abs(border.slope_before), std::abs(border.slope_behind)));
    *csv += fmt::format("\"{}\",{:.1f},{:.1f},{},{},{},{:.5f},{:.5f},{:.5f},{:.5f}\n", name, border.at_deg.x(),
                        border.at_deg.y(), border.is_upwards ? "up" : "along", border.before, border.behind,
                        border.step, border.jump, border.slope_before, border.slope_behind);
  }
  fmt::print("{:<34}{:>8}{}{}{}{:>9.2f}{:>7.2f}{:>8.3f}{:>8.2f}{:>8.2f}{:>8.0f}\n", name, score.borders.size(),
             in_percent(steps), in_percent(jumps), in_percent(slopes), 100.0 * score.mask_sum_error,
             100.0 * score.mask_sum_error_rim, 100.0 * score.mask_off, score.delta_e_mean, score.delta_e_p95,
             100.0 * light.light_kept);
  std::fflush(stdout);
}

}  // namespace

int explain_seams(const ChainCase& chain, const std::filesystem::path& folder, const std::filesystem::path& csv) {
  const auto failed = [](const Error& error) {
    fmt::print(stderr, "calibration_bench: {}\n", error.message());
    return 1;
  };
  const auto preset = simulated::make_preset(chain.name, chain.seed, chain.museum);
  if (!preset) return failed(preset.error());
  const auto museum = simulated::TrueMuseum::make(preset->installation, preset->truth);
  if (!museum) return failed(museum.error());
  const auto calibration = calibration::read_calibration(folder);
  if (!calibration) return failed(calibration.error());
  const auto own = calibration::calibration_folder(folder, calibration->date);
  const auto colours = calibration::read_colours(own);
  if (!colours) return failed(colours.error());
  const auto light = photometry::read_light(own);
  if (!light) return failed(light.error());

  std::vector<photometry::PhotometricProjector> measured;
  std::vector<photometry::PhotometricProjector> true_maps;
  photometry::WallLighting true_lights = *light;
  for (std::size_t p = 0; p < calibration->projectors.size(); ++p) {
    const calibration::CalibratedProjector& projector = calibration->projectors[p];
    measured.push_back({projector.name, projector.map});
    true_maps.push_back({projector.name, true_map(*museum, p, kTrueMap_px)});
    photometry::PictureField& white = true_lights.projectors[p].log_white;
    const photometry::PictureField truth = true_light(*museum, p, white);
    std::vector<double> errors;
    std::vector<double> at_rim;
    for (double y = 0.0; y <= white.height_px; y += 0.02 * white.height_px) {
      for (double x = 0.0; x <= white.width_px; x += 0.02 * white.width_px) {
        const double error = std::abs(white.at({x, y}) - truth.at({x, y}));
        const bool is_rim = std::min({x / white.width_px, y / white.height_px, 1.0 - x / white.width_px,
                                      1.0 - y / white.height_px}) < 0.03;
        (is_rim ? at_rim : errors).push_back(error);
      }
    }
    fmt::print("{}: light off by % (p95, max): inside{}, at the rim{}\n", projector.name, in_percent(errors),
               in_percent(at_rim));
    for (int row = 0; row < 3; ++row) {
      fmt::print("   ");
      for (int column = 0; column <= 16; ++column) {
        const Eigen::Vector2d at(column * white.width_px / 16.0, (0.1 + 0.4 * row) * white.height_px);
        fmt::print("{:>6.2f}", 100.0 * (white.at(at) - truth.at(at)));
      }
      fmt::print("\n");
    }
    white = truth;
  }
  fmt::print("{:<34}{:>8}{:>7}{:>7}{:>7}{:>7}{:>7}{:>7}{:>9}{:>7}{:>8}{:>8}{:>8}{:>8}\n", "%", "borders", "step", "max",
             "jump", "max", "slope", "max", "weights", "rim", "off", "dE", "dE p95", "kept");
  std::string all = "what,azimuth_deg,elevation_deg,way,before,behind,step,jump,slope_before,slope_behind\n";
  struct Variant {
    const char* name;
    const std::vector<photometry::PhotometricProjector>& maps;
    const photometry::WallLighting& light;
    photometry::PhotometryOptions options{};
  };
  photometry::PhotometryOptions flat;
  flat.max_slope_per_deg = flat.max_slope_at_borders_per_deg = 0.0;
  photometry::PhotometryOptions half;
  half.max_slope_at_borders_per_deg = 0.005;
  const Variant variants[] = {{"as measured", measured, *light},
                              {"true maps", true_maps, *light},
                              {"true light", measured, true_lights},
                              {"true maps and light", true_maps, true_lights},
                              {"as measured, flat", measured, *light, flat},
                              {"true maps and light, flat", true_maps, true_lights, flat},
                              {"as measured, 0.5 % at borders", measured, *light, half}};
  for (const Variant& variant : variants) {
    const auto blended = photometry::reblended(variant.maps, variant.light, *colours, variant.options);
    if (!blended) return failed(blended.error());
    tell(variant.name, *blended, seam_score(*museum, *blended), &all);
  }
  if (csv.empty()) return 0;
  const auto written = write_file_atomically(csv, all);
  return written ? 0 : failed(written.error());
}

}  // namespace cyclorama

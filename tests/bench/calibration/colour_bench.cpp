// SPDX-License-Identifier: Apache-2.0
// Brightness and colour of simulated museums with the true geometry: colour_bench rooms|trade|slopes [--quick]. Prints
// a table, then a line of JSON; trade and slopes print CSV. SeamScore in tests/data_sets/photometry_museum.h defines
// the columns; response_rms is the worst channel's.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "common/image/png.h"
#include "tests/data_sets/even_light.h"
#include "tests/data_sets/photometry_museum.h"

namespace cyclorama {
namespace {

using Json = nlohmann::ordered_json;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double rounded(double x) { return std::round(x * 1e5) / 1e5; }

simulated::PresetOptions options_of(bool is_quick) {
  simulated::PresetOptions options;
  options.camera_megapixels = 1.0;
  if (is_quick) {
    options.projector_width_px = 960;
    options.projector_height_px = 540;
    options.camera_megapixels = 0.4;
  }
  return options;
}

Result<simulated::SimulatedMuseum> museum_of(std::string_view room, std::uint32_t seed, bool is_quick) {
  TRY_ASSIGN(const simulated::Preset preset, simulated::make_preset(room, seed, options_of(is_quick)));
  return simulated::SimulatedMuseum::make(preset.installation, preset.truth);
}

int failed(const std::string& room, const Error& error) {
  fmt::print(stderr, "{}: {}\n", room, error.message());
  return 1;
}

int rooms(bool is_quick) {
  fmt::print("{:<20}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>8}{:>8}{:>8}{:>8}\n", "room", "response",
             "mask sum", "at rim", "step p95", "max", "bump p95", "dE mean", "dE p95", "dE max", "black", "before",
             "kept", "flat", "photos", "solve s");
  Json json = Json::object();
  for (const std::string& room : simulated::preset_names()) {
    auto museum = museum_of(room, 1, is_quick);
    if (!museum) return failed(room, museum.error());
    MuseumLightOptions scan;
    if (is_quick) scan.cell_px = 16;
    const auto scanned = photograph_light(&*museum, scan);
    if (!scanned) return failed(room, scanned.error());
    const auto start = std::chrono::steady_clock::now();
    const auto result = photometry::photometry(scanned->input);
    const double solve_s = seconds_since(start);
    if (!result) return failed(room, result.error());
    const SeamScore score = seam_score(museum->truth(), *result);
    const SeamScore before = seam_score(museum->truth(), *result, false);
    const double rms = response_rms(museum->truth(), *result);
    fmt::print(
        "{:<20}{:>9.5f}{:>9.5f}{:>9.5f}{:>9.4f}{:>9.4f}{:>9.4f}{:>9.2f}{:>9.2f}{:>9.2f}{:>9.2f}{:>9.2f}{:>8.3f}{:>8.3f}"
        "{:>8}{:>"
        "8."
        "1f}\n",
        room, rms, score.mask_sum_error, score.mask_sum_error_rim, score.step_p95, score.step_max, score.bump_p95,
        score.delta_e_mean, score.delta_e_p95, score.delta_e_max, score.delta_e_black_p95, before.delta_e_p95,
        result->light_kept, result->light_kept_flat, scanned->photographs, solve_s);
    for (const std::string& remark : result->remarks) fmt::print("  {}\n", remark);
    std::fflush(stdout);
    json[room] = {{"response_rms", rounded(rms)},
                  {"mask_sum_error", rounded(score.mask_sum_error)},
                  {"mask_sum_error_rim", rounded(score.mask_sum_error_rim)},
                  {"seam_step", rounded(score.step_p95)},
                  {"seam_step_max", rounded(score.step_max)},
                  {"seam_bump_p95", rounded(score.bump_p95)},
                  {"seam_de_mean", rounded(score.delta_e_mean)},
                  {"seam_de_p95", rounded(score.delta_e_p95)},
                  {"seam_de_p95_before", rounded(before.delta_e_p95)},
                  {"light_kept", rounded(result->light_kept)},
                  {"light_kept_flat", rounded(result->light_kept_flat)},
                  {"solve_s", rounded(solve_s)}};
  }
  fmt::print("{}\n", json.dump());
  return 0;
}

simulated::PresetOptions small_options(int projectors) {
  simulated::PresetOptions options;
  options.projectors = projectors;
  options.projector_width_px = 480;
  options.projector_height_px = 270;
  options.camera_megapixels = 0.2;
  return options;
}

Result<simulated::SimulatedMuseum> small_museum(std::string_view room, std::uint32_t seed, int bits,
                                                int projectors = 3) {
  TRY_ASSIGN(simulated::Preset preset, simulated::make_preset(room, seed, small_options(projectors)));
  preset.truth.camera.bits = bits;
  return simulated::SimulatedMuseum::make(preset.installation, preset.truth);
}

/// Returns the input of a scan with fewer levels and exposures.
photometry::PhotometryInput thinned(const photometry::PhotometryInput& input, int steps,
                                    const std::vector<double>& exposures_s) {
  constexpr int kFinest = 32;
  photometry::PhotometryInput result = input;
  for (photometry::ProjectorView& view : result.views) {
    std::erase_if(view.readings, [&](const photometry::LightReading& reading) {
      const bool is_level = std::lround(reading.level * kFinest) % (kFinest / (steps - 1)) == 0;
      const bool is_exposed =
          std::ranges::any_of(exposures_s, [&](double e) { return std::abs(reading.exposure_s / e - 1.0) < 1e-6; });
      return !is_level || !(is_exposed || reading.level == 0.0);
    });
  }
  return result;
}

/// The same for a projector with clipped black and white, without photographs, since no simulated museum has one.
int clipped_trade() {
  const auto clipped = [](double code) { return std::pow(std::clamp((code - 0.07) / 0.83, 0.0, 1.0), 2.2); };
  for (const int steps : {5, 9, 17, 33}) {
    EvenLight light;
    light.projector.fill(clipped);
    light.noise = 5e-4;
    light.bits = 12;
    light.steps = steps;
    const auto result = photometry::photometry(even_light({light}));
    if (!result) return failed("a clipped projector", result.error());
    double worst = 0.0;
    for (const photometry::ChannelResponse& response : result->heads.front().response) {
      double sum = 0.0;
      for (int code = 0; code < 256; ++code)
        sum += std::pow(response.light_of(code / 255.0) - clipped(code / 255.0), 2.0) / 256.0;
      worst = std::max(worst, std::sqrt(sum));
    }
    fmt::print("12 clipped,{},1 3,{},{:.5f}\n", steps, 6 * (steps - 1), worst);
  }
  return 0;
}

/// Error of the response by the ramps' levels and exposures: one scan with all of them, thinned out.
int trade(bool is_quick) {
  const std::vector<std::vector<double>> exposures = {{1.0, 1.5}, {1.0, 3.0}, {1.0, 9.0}, {1.0, 3.0, 9.0}};
  fmt::print("bits,steps,exposures,pictures,worst_response_rms\n");
  if (const int code = clipped_trade(); code != 0) return code;
  for (const int bits : {8, 12}) {
    auto museum = small_museum("cylinder126", 2, bits);
    if (!museum) return failed("cylinder126", museum.error());
    MuseumLightOptions scan;
    scan.ramp_steps = 33;
    scan.exposures = {1.0, 1.5, 3.0, 9.0};
    scan.angles_deg = {-36.0, 0.0, 36.0};
    scan.cell_px = 16;
    const auto scanned = photograph_light(&*museum, scan);
    if (!scanned) return failed("cylinder126", scanned.error());
    for (const int steps : {5, 9, 17, 33}) {
      for (const auto& factors : exposures) {
        if (is_quick && steps != 17) continue;
        std::vector<double> wanted_s;
        std::string list;
        for (const double factor : factors) {
          wanted_s.push_back(factor * scanned->white_exposure_s);
          list += fmt::format("{}{:g}", list.empty() ? "" : " ", factor);
        }
        const auto result = photometry::photometry(thinned(scanned->input, steps, wanted_s));
        if (!result) return failed("cylinder126", result.error());
        fmt::print("{},{},{},{},{:.5f}\n", bits, steps, list, 3 * (steps - 1) * static_cast<int>(factors.size()),
                   response_rms(museum->truth(), *result));
        std::fflush(stdout);
      }
    }
  }
  return 0;
}

/// Trade between the smoothness of brightness and the light that is kept.
int slopes(bool is_quick) {
  struct Room {
    const char* name;
    int projectors;
  };
  fmt::print(
      "room,projectors,slope_per_deg,at_borders,light_kept,flat,step_p95,step_max,bump_p95,de_mean,de_p95,masks,masks_"
      "rim\n");
  for (const Room& room : {Room{"cylinder126", 4}, Room{"cylinder126", 3}, Room{"plane", 3}, Room{"corner", 3}}) {
    auto museum = small_museum(room.name, 1, 12, room.projectors);
    if (!museum) return failed(room.name, museum.error());
    MuseumLightOptions scan;
    scan.cell_px = 16;
    scan.ramp_steps = 9;
    const auto scanned = photograph_light(&*museum, scan);
    if (!scanned) return failed(room.name, scanned.error());
    constexpr std::pair<double, double> kSlopes[] = {{0.0, 0.0},   {0.005, 0.005}, {0.01, 0.01}, {0.02, 0.005},
                                                     {0.02, 0.01}, {0.02, 0.015},  {0.02, 0.02}, {0.03, 0.01},
                                                     {0.04, 0.01}, {0.04, 0.04}};
    for (const auto& [slope, at_borders] : kSlopes) {
      photometry::PhotometryOptions options;
      options.max_slope_per_deg = slope;
      options.max_slope_at_borders_per_deg = at_borders;
      const auto result = photometry::photometry(scanned->input, options);
      if (!result) return failed(room.name, result.error());
      const SeamScore score = seam_score(museum->truth(), *result);
      fmt::print("{},{},{},{},{:.3f},{:.3f},{:.4f},{:.4f},{:.4f},{:.3f},{:.3f},{:.4f},{:.4f}\n", room.name,
                 room.projectors, slope, at_borders, result->light_kept, result->light_kept_flat, score.step_p95,
                 score.step_max, score.bump_p95, score.delta_e_mean, score.delta_e_p95, score.mask_sum_error,
                 score.mask_sum_error_rim);
      std::fflush(stdout);
    }
    if (is_quick) break;
  }
  return 0;
}

/// Writes FOLDER/{white,dark}-{before,after}.png of one museum.
int pictures(const std::filesystem::path& folder) {
  auto museum = museum_of("cylinder126", 1, true);
  if (!museum) return failed("cylinder126", museum.error());
  MuseumLightOptions scan;
  scan.cell_px = 16;
  const auto scanned = photograph_light(&*museum, scan);
  if (!scanned) return failed("cylinder126", scanned.error());
  const auto result = photometry::photometry(scanned->input);
  if (!result) return failed("cylinder126", result.error());
  for (const bool is_after : {false, true}) {
    const char* const when = is_after ? "after" : "before";
    const RgbImage white = seen_wall(museum->truth(), *result, 0.5, 90.0, is_after);
    const RgbImage dark = seen_wall(museum->truth(), *result, 0.0, 1.2, is_after);
    for (const auto& [name, picture] : {std::pair("white", &white), std::pair("dark", &dark)}) {
      const auto written = write_png(folder / fmt::format("{}-{}.png", name, when), *picture);
      if (!written) return failed(folder.string(), written.error());
    }
  }
  return 0;
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  const bool is_quick = argc > 2 && std::string(argv[2]) == "--quick";
  if (what == "rooms") return cyclorama::rooms(is_quick);
  if (what == "trade") return cyclorama::trade(is_quick);
  if (what == "slopes") return cyclorama::slopes(is_quick);
  if (what == "pictures" && argc > 2) return cyclorama::pictures(argv[2]);
  fmt::print(stderr, "colour_bench rooms|trade|slopes [--quick], or pictures FOLDER\n");
  return 2;
}

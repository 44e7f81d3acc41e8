// SPDX-License-Identifier: Apache-2.0
// Displaces projectors of calibrated museums and corrects them by realign_projector(): quick_bench [--quick] [--only
// ROOM] [--folder FOLDER]. Museums that are in the folder already are not calibrated again. Prints a table, then a line
// of JSON.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <ctime>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <span>

#include "appliance/calibration/calibration_file.h"
#include "appliance/photometry/light_file.h"
#include "appliance/photometry/reblend.h"
#include "tests/data_sets/photometry_museum.h"
#include "tests/support/displaced_museum.h"

namespace cyclorama {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kDegree = std::numbers::pi / 180.0;

double rounded(double x) { return std::round(x * 1e4) / 1e4; }

/// A clock that counts this process's processor time.
class ProcessorClock final : public Clock {
 public:
  [[nodiscard]] TimePoint now() const override {
    const double seconds = static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
    return TimePoint(std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds)));
  }
};

struct Room {
  const char* key;
  const char* preset;
  int projectors;
};
constexpr Room kRooms[] = {{"cylinder126 3", "cylinder126", 3},
                           {"not-quite-cylinder", "not-quite-cylinder", 3},
                           {"tilted", "tilted", 3},
                           {"bumpy", "bumpy", 3},
                           {"plane", "plane", 3},
                           {"corner", "corner", 3}};
struct Push {
  double degrees;
  double millimetres;
  std::size_t projector;
};
constexpr Push kDisplacements[] = {{0.05, 1.0, 1}, {0.2, 5.0, 1}, {1.0, 20.0, 0}, {1.0, 20.0, 1}, {5.0, 100.0, 1}};

DisplacedMuseum museum_of(const Room& room, std::uint32_t seed, bool is_quick) {
  simulated::PresetOptions options;
  options.projectors = room.projectors;
  if (is_quick) {
    options.projector_width_px = 960;
    options.projector_height_px = 540;
    options.camera_megapixels = 0.6;
  }
  return {*simulated::make_preset(room.preset, seed, options), 70.0 * kDegree, 0.0};
}

bool calibrate(const DisplacedMuseum& museum, const fs::path& folder) {
  if (calibration::read_calibration(folder)) return true;
  fs::remove_all(folder);
  fs::create_directories(folder);
  bool is_done = false;
  const Status inside = museum.inside(
      [&](simulated::SimulatedMuseum& room, const scan::ScanDevices& devices, const scan::ScanSettings& settings) {
        const auto outcome = scan::run_calibration(room.installation(), settings, devices, folder,
                                                   "2026-01-01T00-00-00Z", ProcessorClock(), {}, {});
        if (!outcome) fmt::print("    {}\n", outcome.error().message());
        is_done = outcome.has_value();
      });
  return inside.has_value() && is_done;
}

Json pushed(const Room& room, const Push& push, DisplacedMuseum museum, const fs::path& calibrated) {
  std::mt19937 random(static_cast<unsigned>(1000.0 * push.degrees) + static_cast<unsigned>(push.projector));
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  const Eigen::Vector3d axis(any(random), any(random), 0.5 * any(random));
  const Eigen::Vector3d towards(any(random), any(random), any(random));
  museum.push(push.projector, push.degrees * kDegree, axis, 1e-3 * push.millimetres, towards);
  const fs::path folder = calibrated.string() + "-pushed";
  fs::remove_all(folder);
  fs::copy(calibrated, folder, fs::copy_options::recursive);
  Json json{{"degrees", push.degrees}, {"mm", push.millimetres}, {"projector", push.projector + 1}};
  const Status inside = museum.inside(
      [&](simulated::SimulatedMuseum& in_it, const scan::ScanDevices& devices, const scan::ScanSettings& settings) {
        const MuseumScore before = score_of(in_it, *calibration::read_calibration(folder));
        const double begun_s = in_it.now_s();
        const auto outcome =
            scan::realign_projector(in_it.installation(), in_it.installation().projectors[push.projector].name,
                                    settings, devices, folder, "2026-01-02T00-00-00Z", ProcessorClock(), {}, {});
        const double museum_s = in_it.now_s() - begun_s;
        fmt::print("{:<20}{:>6.2f}{:>6.0f}{:>3}", room.key, push.degrees, push.millimetres, push.projector + 1);
        if (!outcome) {
          fmt::print("  REFUSED after {:.1f} s: {}\n", museum_s, outcome.error().message());
          json["error"] = outcome.error().message();
          return;
        }
        const MuseumScore after = score_of(in_it, *calibration::read_calibration(folder));
        SeamScore seams;
        if (outcome->outcome.light) seams = seam_score(in_it.truth(), *outcome->outcome.light);
        const solve::MeasuredRegistration& told = outcome->outcome.registration;
        fmt::print(
            "{:>9.3f}{:>9.2f}{:>9.3f}{:>8.3f}{:>8.3f}{:>9.3f}{:>6}{:>8.1f}{:>8.1f}{:>8.2f}{:>7.1f}{:>8.2f}{:>8.2f}{:>7."
            "2f}{:>7.2f}{}\n",
            before.mean_px, before.p95_px, after.mean_px, after.p95_px, after.max_px, told.p95_px,
            outcome->outcome.pictures, museum_s, outcome->outcome.solve_s, outcome->turned_rad / kDegree,
            1e3 * outcome->moved_m, outcome->explained_px, 100.0 * seams.step_p95, seams.delta_e_p95,
            100.0 * seams.mask_sum_error, outcome->has_moved ? "" : "  stands");
        json.update(Json::object({{"before_mean_px", rounded(before.mean_px)},
                                  {"before_p95_px", rounded(before.p95_px)},
                                  {"mean_px", rounded(after.mean_px)},
                                  {"p95_px", rounded(after.p95_px)},
                                  {"max_px", rounded(after.max_px)},
                                  {"told_p95_px", rounded(told.p95_px)},
                                  {"patterns", outcome->outcome.pictures},
                                  {"seconds", rounded(museum_s)},
                                  {"solve_s", rounded(outcome->outcome.solve_s)},
                                  {"seam_step", rounded(seams.step_p95)},
                                  {"seam_de_p95", rounded(seams.delta_e_p95)},
                                  {"has_moved", outcome->has_moved}}));
      });
  if (!inside) json["error"] = inside.error().message();
  std::fflush(stdout);
  fs::remove_all(folder);
  return json;
}

/// Records the score of the complete calibration, before any displacement.
void tell_whole(const Room& room, const DisplacedMuseum& museum, const fs::path& calibrated, Json* json) {
  const Status inside =
      museum.inside([&](simulated::SimulatedMuseum& in_it, const scan::ScanDevices&, const scan::ScanSettings&) {
        const calibration::Calibration calibration = *calibration::read_calibration(calibrated);
        const fs::path own = calibration::calibration_folder(calibrated, calibration.date);
        const MuseumScore score = score_of(in_it, calibration);
        std::vector<photometry::PhotometricProjector> projectors;
        for (const calibration::CalibratedProjector& p : calibration.projectors) projectors.push_back({p.name, p.map});
        SeamScore seams;
        const auto light = photometry::read_light(own);
        const auto colours = calibration::read_colours(own);
        const auto blended = light && colours ? photometry::reblended(projectors, *light, *colours)
                                              : Result<photometry::Photometry>(Error(ErrorCode::kNotFound, ""));
        if (blended) seams = seam_score(in_it.truth(), *blended);
        fmt::print("{:<20}{:>15}{:>9}{:>9}{:>9.3f}{:>8.3f}{:>8.3f}{:>63.2f}{:>7.2f}{:>7.2f}\n", room.key, "whole", "",
                   "", score.mean_px, score.p95_px, score.max_px, 100.0 * seams.step_p95, seams.delta_e_p95,
                   100.0 * seams.mask_sum_error);
        json->push_back({{"degrees", 0.0},
                         {"mean_px", rounded(score.mean_px)},
                         {"p95_px", rounded(score.p95_px)},
                         {"max_px", rounded(score.max_px)},
                         {"seam_step", rounded(seams.step_p95)},
                         {"seam_de_p95", rounded(seams.delta_e_p95)}});
      });
  if (!inside) fmt::print("    {}\n", inside.error().message());
  std::fflush(stdout);
}

int rooms(bool is_quick, const std::string& only, std::uint32_t seed, bool only_whole, const fs::path& folder) {
  Json json = Json::object();
  fmt::print("{:<20}{:>6}{:>6}{:>3}{:>9}{:>9}{:>9}{:>8}{:>8}{:>9}{:>6}{:>8}{:>8}{:>8}{:>7}{:>8}{:>8}{:>7}{:>7}\n",
             "room", "deg", "mm", "of", "was mean", "was p95", "mean", "p95", "max", "told p95", "phot", "museum s",
             "cpu s", "deg", "mm", "left px", "step %", "dE p95", "sum %");
  bool is_done = true;
  for (const Room& room : kRooms) {
    const std::string key = room.key;
    if (!only.empty() && only != key) continue;
    if (is_quick && only.empty() && key != "cylinder126 3" && key != "plane") continue;
    const DisplacedMuseum museum = museum_of(room, seed, is_quick);
    const fs::path calibrated = folder / fmt::format("{}-{}{}", room.preset, seed, is_quick ? "-quick" : "");
    if (!calibrate(museum, calibrated)) {
      fmt::print("{:<20}  is not calibrated\n", key);
      is_done = false;
      continue;
    }
    Json pushes = Json::array();
    tell_whole(room, museum, calibrated, &pushes);
    for (const Push& push : only_whole ? std::span<const Push>() : std::span<const Push>(kDisplacements))
      pushes.push_back(pushed(room, push, museum, calibrated));
    for (const Json& one : pushes) is_done = is_done && !one.contains("error");
    json[key] = std::move(pushes);
  }
  fmt::print("{}\n", json.dump());
  return is_done ? 0 : 1;
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  CLI::App app("Pushes projectors of calibrated museums, and puts them back.");
  bool is_quick = false;
  bool only_whole = false;
  std::string only;
  std::uint32_t seed = 1;
  std::string folder = "build/calibration-quick";
  app.add_flag("--quick", is_quick, "Fewer rooms, and smaller");
  app.add_flag("--whole", only_whole, "Push nothing: only how well the rooms are calibrated");
  app.add_option("--only", only, "That room alone");
  app.add_option("--seed", seed, "Of the rooms");
  app.add_option("--folder", folder, "Keeps the rooms' calibrations, which are not made again");
  CLI11_PARSE(app, argc, argv);
  return cyclorama::rooms(is_quick, only, seed, only_whole, folder);
}

// SPDX-License-Identifier: Apache-2.0
// The whole chain in simulated museums: calibration_bench rooms|trade [--quick]. Prints a table; rooms also a line of
// JSON, which trade writes to a file.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/bench/calibration/chain_case.h"
#include "tests/bench/calibration/chain_trade.h"

namespace cyclorama {
namespace {

using Json = nlohmann::ordered_json;

double rounded(double x) { return std::round(x * 1e4) / 1e4; }

struct Room {
  const char* key;
  const char* preset;
  int projectors;
};
constexpr Room kRooms[] = {{"cylinder126 3", "cylinder126", 3},
                           {"cylinder126 4", "cylinder126", 4},
                           {"not-quite-cylinder", "not-quite-cylinder", 3},
                           {"tilted", "tilted", 3},
                           {"bumpy", "bumpy", 3},
                           {"plane", "plane", 3},
                           {"corner", "corner", 3},
                           {"dome", "dome", 3}};

int rooms(bool is_quick, const std::string& only, std::uint32_t seed, const std::filesystem::path& folder) {
  Json json = Json::object();
  fmt::print("{:<20}{:>6}{:>8}{:>8}{:>8}{:>10}{:>9}{:>9}{:>6}{:>10}{:>10}{:>10}{:>9}{:>8}\n", "room", "proj", "mean",
             "p95", "max", "true p95", "missing", "told p95", "dirs", "pictures", "museum s", "s/picture", "solve s",
             "scan cpu");
  bool is_done = true;
  for (const Room& room : kRooms) {
    const std::string key = room.key;
    if (!only.empty() && only != key) continue;
    if (is_quick && only.empty() && key != "cylinder126 3" && key != "plane") continue;
    ChainCase chain;
    chain.name = room.preset;
    chain.seed = seed;
    chain.museum.projectors = room.projectors;
    if (is_quick) {
      chain.museum.projector_width_px = 960;
      chain.museum.projector_height_px = 540;
      chain.museum.camera_megapixels = 0.6;
    }
    const auto result = run_chain(chain, folder);
    if (!result) {
      fmt::print("{:<20}{:>6}  FAILED: {}\n", key, room.projectors, result.error().message());
      json[key] = {{"error", result.error().message()}};
      is_done = false;
      continue;
    }
    const MuseumScore& score = result->score;
    const CalibrationOutcome& outcome = result->outcome;
    const double missing =
        100.0 * static_cast<double>(score.missing) / static_cast<double>(std::max<std::size_t>(1, score.lit));
    const double each = result->museum_s / std::max(1, outcome.pictures);
    fmt::print(
        "{:<20}{:>6}{:>8.3f}{:>8.3f}{:>8.3f}{:>10.3f}{:>8.2f}%{:>9.3f}{:>6}{:>10}{:>10.1f}{:>10.3f}{:>9.1f}{:>8.1f}\n",
        key, room.projectors, score.mean_px, score.p95_px, score.max_px, score.true_p95_px, missing,
        outcome.registration.p95_px, result->directions, outcome.pictures, result->museum_s, each, outcome.solve_s,
        outcome.scan_s);
    if (outcome.light) {
      const SeamScore& seams = result->seams;
      const SeamScore& before = result->seams_before;
      fmt::print(
          "    light: responses {:.2f} %, seams' step p95 {:.2f} % (before {:.1f} %), dE mean {:.2f} p95 {:.2f} "
          "(before {:.1f}, {:.1f}), masks within {:.2f} % (at the rim {:.2f} %), light kept {:.0f} % (flat {:.0f} %); "
          "worst at {:.1f}, {:.1f} deg: step of {:.2f} %, at {:.1f}, {:.1f}: masks\n",
          100.0 * result->response_rms, 100.0 * seams.step_p95, 100.0 * before.step_p95, seams.delta_e_mean,
          seams.delta_e_p95, before.delta_e_mean, before.delta_e_p95, 100.0 * seams.mask_sum_error,
          100.0 * seams.mask_sum_error_rim, 100.0 * outcome.light->light_kept, 100.0 * outcome.light->light_kept_flat,
          seams.step_worst_deg.x(), seams.step_worst_deg.y(), 100.0 * seams.step_max, seams.mask_worst_deg.x(),
          seams.mask_worst_deg.y());
    }
    for (const std::string& remark : outcome.calibration.remarks) fmt::print("    {}\n", remark);
    if (outcome.calibration.wall) fmt::print("    wall: {}\n", outcome.calibration.wall->reason);
    std::fflush(stdout);
    if (!outcome.light) is_done = false;
    json[key] = {{"mean_px", rounded(score.mean_px)},
                 {"p95_px", rounded(score.p95_px)},
                 {"max_px", rounded(score.max_px)},
                 {"true_p95_px", rounded(score.true_p95_px)},
                 {"patterns", outcome.pictures},
                 {"seconds", rounded(result->museum_s)},
                 {"seconds_per_pattern", rounded(each)},
                 {"solve_s", rounded(outcome.solve_s)},
                 {"seam_step", rounded(result->seams.step_p95)},
                 {"seam_de_mean", rounded(result->seams.delta_e_mean)},
                 {"seam_de_p95", rounded(result->seams.delta_e_p95)},
                 {"response_rms", rounded(result->response_rms)},
                 {"mask_sum_error", rounded(result->seams.mask_sum_error)},
                 {"mask_sum_error_rim", rounded(result->seams.mask_sum_error_rim)},
                 {"places", score.places},
                 {"projector_width_px", chain.museum.projector_width_px},
                 {"camera_megapixels", chain.museum.camera_megapixels},
                 {"seed", seed}};
  }
  fmt::print("{}\n", json.dump());
  return is_done ? 0 : 1;
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  CLI::App app("Calibrations of simulated museums, scored by their truth.");
  app.require_subcommand(1);
  bool is_quick = false;
  std::string only;
  std::uint32_t seed = 1;
  std::string folder = "build/calibration-bench";
  CLI::App* rooms = app.add_subcommand("rooms", "Every kind of room");
  CLI::App* trade = app.add_subcommand("trade", "One knob at a time");
  std::string json;
  trade->add_option("--json", json, "For the figures")->required();
  cyclorama::Records::Options kept;
  unsigned seeds = 1;
  trade->add_option("--seeds", seeds, "Museums for each point; their mean is told");
  trade->add_option("--records", kept.file, "Keeps each point, and does not run it again");
  trade->add_option("--seconds", kept.seconds, "Begins no point after so many, and ends with 75");
  trade->add_option("--only", kept.only, "Points whose knob and value begin so");
  for (CLI::App* command : {rooms, trade}) {
    command->add_flag("--quick", is_quick, "Fewer of them, and smaller");
    command->add_option("--folder", folder, "For what is measured; emptied afterwards");
  }
  rooms->add_option("--only", only, "That one alone");
  rooms->add_option("--seed", seed, "Of the rooms");
  CLI11_PARSE(app, argc, argv);
  if (trade->parsed()) {
    cyclorama::Records records(kept);
    return cyclorama::trade(is_quick, seeds, folder, json, &records);
  }
  return cyclorama::rooms(is_quick, only, seed, folder);
}

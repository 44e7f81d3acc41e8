// SPDX-License-Identifier: Apache-2.0
// Complete calibrations in simulated museums: calibration_bench rooms|trade|seams|distorted [--quick]. Prints a table; rooms also
// prints a line of JSON, which trade writes to a file.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/bench/calibration/chain_case.h"
#include "tests/bench/calibration/chain_distorted.h"
#include "tests/bench/calibration/chain_seams.h"
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

ChainCase case_of(const Room& room, std::uint32_t seed, bool is_quick) {
  ChainCase chain;
  chain.name = room.preset;
  chain.seed = seed;
  chain.museum.projectors = room.projectors;
  if (is_quick) {
    chain.museum.projector_width_px = 960;
    chain.museum.projector_height_px = 540;
    chain.museum.camera_megapixels = 0.6;
  }
  return chain;
}

int seams(bool is_quick, const std::string& only, std::uint32_t seed, const std::filesystem::path& folder,
          const std::filesystem::path& csv) {
  for (const Room& room : kRooms) {
    if (only == room.key) return explain_seams(case_of(room, seed, is_quick), folder, csv);
  }
  fmt::print(stderr, "calibration_bench: no room '{}'\n", only);
  return 2;
}

int rooms(bool is_quick, const std::string& only, std::uint32_t seed, const std::filesystem::path& folder, bool keeps) {
  Json json = Json::object();
  fmt::print("{:<20}{:>6}{:>8}{:>8}{:>8}{:>10}{:>9}{:>9}{:>6}{:>10}{:>10}{:>10}{:>9}{:>8}\n", "room", "proj", "mean",
             "p95", "max", "true p95", "missing", "told p95", "dirs", "pictures", "museum s", "s/picture", "solve s",
             "scan cpu");
  bool is_done = true;
  for (const Room& room : kRooms) {
    const std::string key = room.key;
    if (!only.empty() && only != key) continue;
    if (is_quick && only.empty() && key != "cylinder126 3" && key != "plane") continue;
    ChainCase chain = case_of(room, seed, is_quick);
    chain.keeps_folder = keeps;
    const auto result = run_chain(chain, keeps ? folder / key : folder);
    if (!result) {
      fmt::print("{:<20}{:>6}  FAILED: {}\n", key, room.projectors, result.error().message());
      json[key] = {{"error", result.error().message()}};
      is_done = false;
      continue;
    }
    const MuseumScore& score = result->score;
    const scan::CalibrationOutcome& outcome = result->outcome;
    const double missing =
        100.0 * static_cast<double>(score.missing) / static_cast<double>(std::max<std::size_t>(1, score.lit));
    const double each = result->museum_s / std::max(1, outcome.pictures);
    fmt::print(
        "{:<20}{:>6}{:>8.3f}{:>8.3f}{:>8.3f}{:>10.3f}{:>8.2f}%{:>9.3f}{:>6}{:>10}{:>10.1f}{:>10.3f}{:>9.1f}{:>8.1f}\n",
        key, room.projectors, score.mean_px, score.p95_px, score.max_px, score.true_p95_px, missing,
        outcome.registration.p95_px, result->directions, outcome.pictures, result->museum_s, each, outcome.solve_s,
        outcome.scan_s);
    fmt::print("    exposed {:.1f} s for places, {:.1f} s for light\n", result->patterns_exposed_s,
               result->light_exposed_s);
    if (outcome.light) {
      const SeamScore& seams = result->seams;
      const SeamScore& before = result->seams_before;
      fmt::print(
          "    light: responses {:.2f} %, seams' step p95 {:.2f} % (before {:.1f} %), jump {:.2f} %, dE mean {:.2f} "
          "p95 {:.2f} "
          "(before {:.1f}, {:.1f}), masks within {:.2f} % (at the rim {:.2f} %, {:.3f} % of places beyond 0.5 %), "
          "light kept {:.0f} % (flat {:.0f} %); "
          "worst at {:.1f}, {:.1f} deg: step of {:.2f} %, at {:.1f}, {:.1f}: masks\n",
          100.0 * result->response_rms, 100.0 * seams.step_p95, 100.0 * before.step_p95, 100.0 * seams.jump_p95,
          seams.delta_e_mean, seams.delta_e_p95, before.delta_e_mean, before.delta_e_p95, 100.0 * seams.mask_sum_error,
          100.0 * seams.mask_sum_error_rim, 100.0 * seams.mask_off, 100.0 * outcome.light->light_kept,
          100.0 * outcome.light->light_kept_flat, seams.step_worst_deg.x(), seams.step_worst_deg.y(),
          100.0 * seams.step_max, seams.mask_worst_deg.x(), seams.mask_worst_deg.y());
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
                 {"exposed_s", rounded(result->patterns_exposed_s + result->light_exposed_s)},
                 {"solve_s", rounded(outcome.solve_s)},
                 {"seam_step", rounded(result->seams.step_p95)},
                 {"seam_jump", rounded(result->seams.jump_p95)},
                 {"seam_de_mean", rounded(result->seams.delta_e_mean)},
                 {"seam_de_p95", rounded(result->seams.delta_e_p95)},
                 {"response_rms", rounded(result->response_rms)},
                 {"mask_sum_error", rounded(result->seams.mask_sum_error)},
                 {"mask_sum_error_rim", rounded(result->seams.mask_sum_error_rim)},
                 {"mask_off", result->seams.mask_off},
                 {"places", score.correspondences},
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
  CLI::App* distorted =
      app.add_subcommand("distorted", "Optics, cameras and walls as they are sold, each alone and all");
  distorted->add_option("--json", json, "For the figures")->required();
  distorted->add_option("--records", kept.file, "Keeps each case, and does not run it again");
  distorted->add_option("--seconds", kept.seconds, "Begins no case after so many, and ends with 75");
  distorted->add_option("--only", kept.only, "Cases whose name begins so");
  CLI::App* seams = app.add_subcommand("seams", "Where a kept room's steps and weights come from");
  std::string csv;
  bool keeps = false;
  for (CLI::App* command : {rooms, trade, seams, distorted})
    command->add_flag("--quick", is_quick, "Fewer of them, and smaller");
  for (CLI::App* command : {rooms, trade, distorted})
    command->add_option("--folder", folder, "For what is measured; emptied afterwards");
  rooms->add_flag("--keep", keeps, "FOLDER/ROOM holds the calibration afterwards");
  seams->add_option("--calibration", folder, "A room's that was kept")->required();
  seams->add_option("--csv", csv, "For all borders");
  rooms->add_option("--only", only, "That one alone");
  seams->add_option("--only", only, "The room")->required();
  for (CLI::App* command : {rooms, seams, distorted}) command->add_option("--seed", seed, "Of the rooms");
  CLI11_PARSE(app, argc, argv);
  if (distorted->parsed()) {
    cyclorama::Records records(kept);
    return cyclorama::distorted(is_quick, seed, folder, json, &records);
  }
  if (trade->parsed()) {
    cyclorama::Records records(kept);
    return cyclorama::trade(is_quick, seeds, folder, json, &records);
  }
  if (seams->parsed()) return cyclorama::seams(is_quick, only, seed, folder, csv);
  return cyclorama::rooms(is_quick, only, seed, folder, keeps);
}

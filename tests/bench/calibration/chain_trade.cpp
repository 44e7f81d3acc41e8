// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/calibration/chain_trade.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "common/base/file.h"
#include "tests/bench/calibration/chain_case.h"

namespace cyclorama {
namespace {

using Json = nlohmann::ordered_json;

struct TradePoint {
  std::string knob;
  std::string value;
  ChainCase chain;
};

ChainCase base_case() {
  ChainCase chain;
  chain.name = "cylinder126";
  // A quarter of full HD each way, and of a camera of 2.4 megapixels: the same pixels on each other, less work.
  chain.museum.projector_width_px = 480;
  chain.museum.projector_height_px = 270;
  chain.museum.camera_megapixels = 0.15;
  chain.with_wall = false;  // No knob of the scan; it would cost as much as the rest.
  return chain;
}

std::vector<TradePoint> points(bool is_quick) {
  std::vector<TradePoint> all;
  const auto add = [&](const char* knob, std::string value, const auto& change) {
    TradePoint point{knob, std::move(value), base_case()};
    change(&point.chain);
    all.push_back(std::move(point));
  };
  const auto patterns = [&](const char* value, int finest, int base, double period, int steps) {
    add("patterns", value, [=](ChainCase* chain) {
      chain->view.finest_bit = finest;
      chain->view.base_bit = base;
      chain->view.phase_period_px = period;
      chain->view.phase_steps = steps;
      // XOR codes see through light that comes by way of other walls (docs/design/structured-light.md).
      if (base >= 0) {
        chain->view.decode.least_direct_share = 0.1;
        chain->view.decode.undecided.contrast = 0.02;
      }
    });
  };
  patterns("bits to 0", 0, -1, 0.0, 0);
  patterns("bits to 1", 1, -1, 0.0, 0);
  patterns("bits to 2", 2, -1, 0.0, 0);
  patterns("bits to 3", 3, -1, 0.0, 0);
  patterns("bits to 2, 3 phases of 16 px", 2, -1, 16.0, 3);
  patterns("bits to 2, 5 phases of 16 px", 2, -1, 16.0, 5);
  patterns("bits to 3, 4 phases of 32 px", 3, -1, 32.0, 4);
  patterns("XOR with bit 1", 0, 1, 0.0, 0);
  for (const int times : {1, 2, 4}) {
    add("photographs", std::to_string(times), [=](ChainCase* chain) { chain->view.photographs = times; });
  }
  for (const double megapixels :
       is_quick ? std::vector<double>{0.06, 0.3} : std::vector<double>{0.04, 0.06, 0.1, 0.15, 0.3, 0.6}) {
    add("camera, megapixels", fmt::format("{}", megapixels),
        [=](ChainCase* chain) { chain->museum.camera_megapixels = megapixels; });
  }
  for (const int directions : {2, 3, 4, 6}) {
    add("directions", std::to_string(directions), [=](ChainCase* chain) { chain->directions = directions; });
  }
  if (is_quick) std::erase_if(all, [n = 0](const TradePoint&) mutable { return n++ % 2 != 0; });
  return all;
}

}  // namespace

int trade(bool is_quick, const std::filesystem::path& folder, const std::filesystem::path& json_file) {
  Json json = Json::array();
  fmt::print("{:<20}{:<30}{:>8}{:>8}{:>8}{:>10}{:>10}{:>10}{:>9}\n", "knob", "value", "mean", "p95", "max", "true p95",
             "pictures", "museum s", "solve s");
  for (const TradePoint& point : points(is_quick)) {
    const auto result = run_chain(point.chain, folder);
    if (!result) {
      fmt::print("{:<20}{:<30}  {}\n", point.knob, point.value, result.error().message());
      continue;
    }
    const MuseumScore& score = result->score;
    fmt::print("{:<20}{:<30}{:>8.3f}{:>8.3f}{:>8.3f}{:>10.3f}{:>10}{:>10.1f}{:>9.2f}\n", point.knob, point.value,
               score.mean_px, score.p95_px, score.max_px, score.true_p95_px, result->outcome.pictures, result->museum_s,
               result->outcome.solve_s);
    std::fflush(stdout);
    json.push_back({{"knob", point.knob},
                    {"value", point.value},
                    {"mean_px", score.mean_px},
                    {"p95_px", score.p95_px},
                    {"max_px", score.max_px},
                    {"true_p95_px", score.true_p95_px},
                    {"pictures", result->outcome.pictures},
                    {"museum_s", result->museum_s},
                    {"solve_s", result->outcome.solve_s}});
  }
  if (const auto written = write_file_atomically(json_file, json.dump(1)); !written) {
    fmt::print(stderr, "calibration_bench: {}\n", written.error().message());
    return 1;
  }
  return 0;
}

}  // namespace cyclorama

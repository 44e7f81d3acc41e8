// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/calibration/chain_trade.h"

#include <fmt/format.h>

#include "common/base/file.h"
#include "tests/bench/calibration/chain_case.h"
#include "tests/bench/calibration/chain_models.h"

namespace cyclorama {
namespace {

using Json = nlohmann::ordered_json;

struct TradePoint {
  std::string knob;
  std::string value;
  ChainCase chain;
  bool is_default = false;
};

ChainCase base_case() {
  ChainCase chain;
  chain.name = "cylinder126";
  // A quarter of full HD in each direction, and the same of a camera of 2.4 megapixels: the same ratio of pixels with
  // less work.
  chain.museum.projector_width_px = 480;
  chain.museum.projector_height_px = 270;
  chain.museum.camera_megapixels = 0.15;
  chain.with_wall = false;  // Not affected by any parameter of the scan, and as expensive as everything else together.
  return chain;
}

std::vector<TradePoint> points(bool is_quick) {
  std::vector<TradePoint> all;
  const scan::ViewSettings usual;
  const auto add = [&](const char* knob, std::string value, bool is_default, const auto& change) {
    TradePoint point{knob, std::move(value), base_case(), is_default};
    change(&point.chain);
    all.push_back(std::move(point));
  };
  const auto patterns = [&](const char* value, int finest, int base, double period, int steps) {
    const bool is_default = finest == usual.finest_bit && base == usual.base_bit && steps == usual.phase_steps;
    add("patterns", value, is_default, [=](ChainCase* chain) {
      chain->view.finest_bit = finest;
      chain->view.base_bit = base;
      chain->view.phase_period_px = period;
      chain->view.phase_steps = steps;
      // XOR codes are robust against light that arrives by way of other walls (docs/design/structured-light.md).
      if (base >= 0) {
        chain->view.decode.min_direct_share = 0.1;
        chain->view.decode.undecided.contrast = 0.02;
      }
    });
  };
  patterns("bits to 0", 0, -1, 0.0, 0);
  patterns("bits to 1", 1, -1, 0.0, 0);
  patterns("bits to 2", 2, -1, 0.0, 0);
  patterns("bits to 3", 3, -1, 0.0, 0);
  patterns("bits to 4", 4, -1, 0.0, 0);
  patterns("bits to 2, 3 phases of 16 px", 2, -1, 16.0, 3);
  patterns("bits to 2, 5 phases of 16 px", 2, -1, 16.0, 5);
  patterns("bits to 3, 4 phases of 32 px", 3, -1, 32.0, 4);
  patterns("XOR with bit 1", 0, 1, 0.0, 0);
  for (const int times : {1, 2, 4}) {
    add("photographs", std::to_string(times), times == usual.photographs,
        [=](ChainCase* chain) { chain->view.photographs = times; });
  }
  for (const double megapixels :
       is_quick ? std::vector<double>{0.06, 0.3} : std::vector<double>{0.04, 0.06, 0.1, 0.15, 0.3, 0.6}) {
    add("camera, megapixels", fmt::format("{}", megapixels), megapixels == base_case().museum.camera_megapixels,
        [=](ChainCase* chain) { chain->museum.camera_megapixels = megapixels; });
  }
  for (const int directions : {2, 3, 4, 6}) {
    add("directions", std::to_string(directions), directions == 3,  // The number planned for this room.
        [=](ChainCase* chain) { chain->directions = directions; });
  }
  if (is_quick) std::erase_if(all, [n = 0](const TradePoint&) mutable { return n++ % 2 != 0; });
  return all;
}

Json run_point(const TradePoint& point, std::uint32_t seed, const std::filesystem::path& folder) {
  ChainCase chain = point.chain;
  chain.seed = seed;
  const auto result = run_chain(chain, folder);
  if (!result) return {{"why", result.error().message()}};
  const MuseumScore& score = result->score;
  return {{"mean_px", score.mean_px},
          {"p95_px", score.p95_px},
          {"max_px", score.max_px},
          {"true_p95_px", score.true_p95_px},
          {"missing", static_cast<double>(score.missing) / static_cast<double>(std::max<std::size_t>(1, score.lit))},
          {"pictures", result->outcome.pictures},
          {"museum_s", result->museum_s},
          {"solve_s", result->outcome.solve_s}};
}

/// Mean over the seeds; for max_px and missing, the maximum.
Json together(const std::vector<Json>& records) {
  Json sum = Json::object();
  for (const Json& record : records) {
    for (const auto& [key, value] : record.items()) {
      if (!value.is_number()) continue;
      const double here = value.get<double>();
      const double before = sum.value(key, 0.0);
      const bool is_worst = key == "max_px" || key == "missing";
      sum[key] = is_worst ? std::max(before, here) : before + here / static_cast<double>(records.size());
    }
  }
  return sum;
}

}  // namespace

int trade(bool is_quick, unsigned seeds, const std::filesystem::path& folder, const std::filesystem::path& json_file,
          Records* records) {
  Json json = Json::array();
  fmt::print("{:<20}{:<30}{:>6}{:>8}{:>8}{:>8}{:>10}{:>9}{:>10}{:>10}{:>9}\n", "knob", "value", "seeds", "mean", "p95",
             "max", "true p95", "missing", "pictures", "museum s", "solve s");
  const auto tell = [&](const std::string& knob, const std::string& value, bool is_default,
                        const std::vector<Json>& of_seeds) {
    std::vector<Json> good;
    for (const Json& record : of_seeds) {
      if (!record.contains("why")) good.push_back(record);
      if (record.contains("why")) fmt::print("{:<20}{:<30}{}\n", knob, value, record["why"].get<std::string>());
    }
    if (good.empty()) return;
    Json point{{"knob", knob}, {"value", value}, {"default", is_default}, {"seeds", good.size()}};
    point.update(together(good));
    fmt::print("{:<20}{:<30}{:>6}{:>8.3f}{:>8.3f}{:>8.3f}{:>10.3f}{:>8.2f}%{:>10.0f}{:>10.1f}{:>9.2f}\n", knob, value,
               good.size(), point["mean_px"].get<double>(), point["p95_px"].get<double>(),
               point["max_px"].get<double>(), point["true_p95_px"].get<double>(),
               100.0 * point["missing"].get<double>(), point["pictures"].get<double>(), point["museum_s"].get<double>(),
               point["solve_s"].get<double>());
    std::fflush(stdout);
    json.push_back(std::move(point));
  };
  for (const TradePoint& point : points(is_quick)) {
    std::vector<Json> of_seeds;
    for (unsigned seed = 1; seed <= seeds; ++seed) {
      const auto record = records->get(fmt::format("{}, {}, {}", point.knob, point.value, seed),
                                       [&] { return run_point(point, seed, folder); });
      if (record) of_seeds.push_back(*record);
    }
    tell(point.knob, point.value, point.is_default, of_seeds);
  }
  for (const std::string room : {"cylinder126", "not-quite-cylinder"}) {
    ChainCase chain = base_case();
    chain.name = room;
    if (is_quick && room != "cylinder126") continue;
    const auto record = records->get("models, " + room, [&] { return model_points(chain, folder); });
    if (!record) continue;
    if (record->contains("why")) fmt::print("{}: {}\n", room, record->at("why").get<std::string>());
    for (const Json& model : record->value("models", Json::array()))
      tell("model, " + room, model["value"], model["default"], {model});
  }
  if (records->exit_code() != 0) return records->exit_code();
  if (const auto written = write_file_atomically(json_file, json.dump(1)); !written) {
    fmt::print(stderr, "calibration_bench: {}\n", written.error().message());
    return 1;
  }
  return 0;
}

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/calibration/chain_distorted.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "common/base/file.h"
#include "drivers/simulated/museum/as_sold.h"
#include "tests/bench/calibration/chain_case.h"

namespace cyclorama {
namespace {

using Json = nlohmann::ordered_json;

/// A quarter of the pixels each way, seen by a camera with as much less: all is the same but for the cells of the maps.
constexpr int kQuickRows = 270;

struct Goal {
  double p95_px = 1.2;  ///< At 1080 rows.
  double stated_times =
      2.0;  ///< A result beyond the goal is confidently wrong if it is so many times worse than stated.
};

struct Case {
  std::string name;
  std::string room;
  std::vector<std::string> as_sold;
};

std::vector<Case> cases(bool is_quick) {
  std::vector<Case> list{{"none", "cylinder126", {}}};
  for (const std::string& kind : simulated::as_sold_kinds()) list.push_back({kind, "cylinder126", {kind}});
  std::vector<std::string> optics = simulated::as_sold_kinds();
  std::erase(optics, "exposure");
  list.push_back({"all", "cylinder126", optics});
  list.push_back({"all and exposure", "cylinder126", simulated::as_sold_kinds()});
  if (!is_quick) {
    for (const char* const room : {"not-quite-cylinder", "corner", "dome"})
      list.push_back({fmt::format("all {}", room), room, optics});
  }
  return list;
}

double rounded(double x) { return std::round(x * 1e4) / 1e4; }

/// Part of the values, the smallest of which comes first, that a limit covers.
double part_within(const std::vector<double>& sorted, double limit) {
  if (sorted.empty()) return 0.0;
  return static_cast<double>(std::ranges::upper_bound(sorted, limit) - sorted.begin()) /
         static_cast<double>(sorted.size());
}

Json run_case(const Case& as_sold, bool is_quick, std::uint32_t seed, const std::filesystem::path& folder) {
  ChainCase chain;
  chain.name = as_sold.room;
  chain.seed = seed;
  chain.as_sold = as_sold.as_sold;
  if (is_quick) {
    chain.museum.projector_width_px = 480;
    chain.museum.projector_height_px = kQuickRows;
    chain.museum.camera_megapixels = 0.15;
  }
  const auto result = run_chain(chain, folder);
  if (!result) return {{"refused", result.error().message()}};
  const MuseumScore& score = result->score;
  const double stated_px = result->outcome.registration.p95_px;
  const Goal goal;
  const double allowed_px = goal.p95_px * chain.museum.projector_height_px / 1080.0;
  Json json = {{"mean_px", rounded(score.mean_px)},
               {"p95_px", rounded(score.p95_px)},
               {"max_px", rounded(score.max_px)},
               {"stated_p95_px", rounded(stated_px)},
               {"true_p95_px", rounded(score.true_p95_px)},
               {"registration_covered", rounded(part_within(score.apart_px, stated_px))},
               {"direction_covered", rounded(score.covered_95)},
               {"missing",
                rounded(static_cast<double>(score.missing) / static_cast<double>(std::max<std::size_t>(1, score.lit)))},
               {"is_confident_wrong", score.p95_px > allowed_px && score.p95_px > goal.stated_times * stated_px},
               {"has_light", result->outcome.light.has_value()}};
  if (result->outcome.light) {
    json["seam_step_p95"] = rounded(result->seams.step_p95);
    json["seam_de_p95"] = rounded(result->seams.delta_e_p95);
    json["response_rms"] = rounded(result->response_rms);
  }
  json["remarks"] = result->outcome.calibration.remarks;
  return json;
}

void print(const std::string& name, const Json& json) {
  if (json.contains("refused")) {
    fmt::print("{:<22}refused: {}\n", name, json["refused"].get<std::string>());
    return;
  }
  const auto of = [&](const char* key) { return json[key].get<double>(); };
  fmt::print("{:<22}{:>8.3f}{:>8.3f}{:>8.3f}{:>11.3f}{:>10.3f}{:>8.1f}%{:>8.1f}%{:>8.2f}%", name, of("mean_px"),
             of("p95_px"), of("max_px"), of("stated_p95_px"), of("true_p95_px"), 100.0 * of("registration_covered"),
             100.0 * of("direction_covered"), 100.0 * of("missing"));
  if (json["has_light"].get<bool>()) {
    fmt::print("{:>9.2f}%{:>9.2f}{:>9.2f}%", 100.0 * of("seam_step_p95"), of("seam_de_p95"),
               100.0 * of("response_rms"));
  } else {
    fmt::print("  no light");
  }
  fmt::print("{}\n", json["is_confident_wrong"].get<bool>() ? "  CONFIDENTLY WRONG" : "");
}

}  // namespace

int distorted(bool is_quick, std::uint32_t seed, const std::filesystem::path& folder, const std::filesystem::path& file,
              Records* records) {
  fmt::print("projectors of {} rows, seed {}; distances in projector pixels\n", is_quick ? kQuickRows : 1080, seed);
  fmt::print("{:<22}{:>8}{:>8}{:>8}{:>11}{:>10}{:>9}{:>9}{:>9}{:>10}{:>9}{:>10}\n", "as sold", "mean", "p95", "max",
             "stated p95", "true p95", "covered", "true cov", "missing", "step p95", "dE p95", "response");
  Json figures = Json::object();
  int wrong = 0;
  int accepted = 0;
  double registration = 0.0;
  double direction = 0.0;
  for (const Case& as_sold : cases(is_quick)) {
    const std::string key = fmt::format("{} {} {}", as_sold.name, is_quick ? kQuickRows : 1080, seed);
    auto json = records->get(key, [&] { return run_case(as_sold, is_quick, seed, folder); });
    if (!json) continue;
    print(as_sold.name, *json);
    std::fflush(stdout);
    if (!json->contains("refused") && (*json)["is_confident_wrong"].get<bool>()) ++wrong;
    if (!json->contains("refused")) {
      ++accepted;
      registration += (*json)["registration_covered"].get<double>();
      direction += (*json)["direction_covered"].get<double>();
    }
    json->erase("key");
    figures[as_sold.name] = *json;
  }
  figures["confident_wrong"] = wrong;
  if (accepted > 0) {
    figures["covered_95"] = {{"registration", rounded(registration / accepted)},
                             {"direction", rounded(direction / accepted)}};
    fmt::print("within the stated 95 %: registration {:.1f} %, directions {:.1f} %; confidently wrong: {} of {}\n",
               100.0 * registration / accepted, 100.0 * direction / accepted, wrong, accepted);
  }
  const Status written = write_file_atomically(file, figures.dump() + "\n");
  if (!written) fmt::print(stderr, "calibration_bench: {}\n", written.error().message());
  return written ? records->exit_code() : 1;
}

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
// Solves the measurements of generated rooms: solve_bench registration|model|extremes [SEEDS] [--records FILE]
// [--seconds S] [--only NAME]. Prints a table, then a line of JSON. With a file of records each case is run only once,
// and no case is started after S seconds (the exit code is then 75: continue later).
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "appliance/solve/calibrate.h"
#include "tests/bench/records.h"
#include "tests/data_sets/generated_room.h"

namespace cyclorama {
namespace {

using Json = nlohmann::ordered_json;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Time of this process, since the machine may be shared.
double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double rounded(double x) { return std::round(x * 1e4) / 1e4; }

RegistrationScore score_of(const GeneratedRoom& room, const calibration::Calibration& calibration) {
  return registration_score(
      room, [&](std::size_t p, const Eigen::Vector2d& px) { return calibration.projectors[p].map.direction_at(px); });
}

RoomPlan plan_of(RoomKind kind, unsigned seed) {
  RoomPlan plan;
  plan.kind = kind;
  plan.seed = seed;
  if (kind == RoomKind::kPlane || kind == RoomKind::kCorner) plan.arc_rad = 1.5;
  if (kind == RoomKind::kPlane) plan.arc_rad = 1.2;
  return plan;
}

Json register_one(RoomKind kind, int projectors, unsigned seed) {
  RoomPlan plan = plan_of(kind, seed);
  plan.projectors = projectors;
  plan.stride_px = 4;
  const GeneratedRoom room(plan);
  const solve::Measurements measurements = room.measurements();
  const double cpu_start = cpu_seconds();
  const auto start = std::chrono::steady_clock::now();
  const auto calibration = solve::calibrate(measurements, "2026-01-01T00-00-00Z");
  Json record{{"solve_s", seconds_since(start)}, {"cpu_s", cpu_seconds() - cpu_start}};
  if (!calibration) {
    record["why"] = calibration.error().message();
    return record;
  }
  const RegistrationScore score = score_of(room, *calibration);
  record.update({{"mean_px", score.mean_px},
                 {"p95_px", score.p95_px},
                 {"max_px", score.max_px},
                 {"true_p95_px", score.true_p95_px},
                 {"true_max_px", score.true_max_px},
                 {"missing", score.missing},
                 {"offset", calibration->turntable.offset_reason},
                 {"wall", calibration->wall ? calibration->wall->reason : calibration->remarks.back()}});
  return record;
}

/// Maps of three and four projectors of 1080p: without a model of the wall, and with one to measure its time.
int registration(unsigned seeds, Records* records) {
  Json json = Json::object();
  fmt::print("{:<10}{:>5}{:>6}{:>9}{:>9}{:>9}{:>10}{:>10}{:>9}{:>9}{:>9}\n", "room", "proj", "seeds", "mean", "p95",
             "max", "true p95", "true max", "missing", "solve s", "cpu s");
  for (const RoomKind kind : kRoomKinds) {
    for (const int projectors : {3, 4}) {
      const std::string name = fmt::format("{} {}", name_of(kind), projectors);
      std::map<std::string, double> worst;
      double mean = 0.0;
      unsigned run = 0;
      for (unsigned seed = 1; seed <= seeds; ++seed) {
        const auto record =
            records->get(fmt::format("{} {}", name, seed), [&] { return register_one(kind, projectors, seed); });
        if (!record) continue;
        ++run;
        if (record->contains("why")) {
          fmt::print("{} of seed {}: {}\n", name, seed, record->at("why").get<std::string>());
          worst["max_px"] = std::numeric_limits<double>::infinity();
        }
        for (const char* key : {"p95_px", "max_px", "true_p95_px", "true_max_px", "missing", "solve_s", "cpu_s"}) {
          worst[key] = std::max(worst[key], record->value(key, 0.0));
        }
        mean += record->value("mean_px", 0.0);
      }
      if (run == 0) continue;
      mean /= run;
      fmt::print("{:<10}{:>5}{:>6}{:>9.3f}{:>9.3f}{:>9.3f}{:>10.3f}{:>10.3f}{:>9}{:>9.2f}{:>9.2f}\n", name_of(kind),
                 projectors, run, mean, worst["p95_px"], worst["max_px"], worst["true_p95_px"], worst["true_max_px"],
                 worst["missing"], worst["solve_s"], worst["cpu_s"]);
      std::fflush(stdout);
      json[name] = {{"mean_px", rounded(mean)},
                    {"p95_px", rounded(worst["p95_px"])},
                    {"max_px", rounded(worst["max_px"])},
                    {"solve_s", rounded(worst["solve_s"])},
                    {"cpu_s", rounded(worst["cpu_s"])},
                    {"true_p95_px", rounded(worst["true_p95_px"])},
                    {"seeds", run}};
    }
  }
  fmt::print("{}\n", json.dump());
  return records->exit_code();
}

calibration::SurfaceModel right_model(RoomKind kind) {
  switch (kind) {
    case RoomKind::kPlane:
      return calibration::SurfaceModel::kPlane;
    case RoomKind::kCylinder:
    case RoomKind::kTiltedCylinder:
      return calibration::SurfaceModel::kCylinder;
    case RoomKind::kUnevenCylinder:
    case RoomKind::kCorner:
      return calibration::SurfaceModel::kProfile;
    case RoomKind::kDome:
      return calibration::SurfaceModel::kQuadric;
    case RoomKind::kBumpy:
      return calibration::SurfaceModel::kMesh;
  }
  return calibration::SurfaceModel::kPlane;
}

Json choose_one(RoomKind kind, unsigned seed) {
  RoomPlan plan = plan_of(kind, seed);
  plan.stride_px = 12;
  const auto calibration = solve::calibrate(GeneratedRoom(plan).measurements(), "2026-01-01T00-00-00Z");
  if (!calibration || !calibration->wall) {
    return {{"chosen", calibration ? calibration->remarks.back() : calibration.error().message()}, {"right", false}};
  }
  const calibration::SurfaceModel model = calibration->wall->fit.surface.model;
  Json record{{"chosen", name_of(model)},
              {"right", model == right_model(kind) ||
                            (kind == RoomKind::kCorner && model == calibration::SurfaceModel::kQuadric)}};
  for (const calibration::ModelTrial& trial : calibration->wall->surfaces) {
    if (trial.name == name_of(model)) record["heldout_px"] = trial.heldout_rms_px;
    record["trials"].push_back({{"name", trial.name},
                                {"training_px", rounded(trial.training_rms_px)},
                                {"heldout_px", rounded(trial.heldout_rms_px)},
                                {"scatter", rounded(trial.scatter)},
                                {"usable", trial.is_usable}});
  }
  record["richest_px"] = calibration->wall->surfaces.back().heldout_rms_px;
  // A model with fewer parameters predicted better, by more than the tolerance.
  for (const calibration::ModelTrial& trial : calibration->wall->surfaces) {
    if (trial.name == name_of(model)) break;
    if (trial.is_usable && trial.heldout_rms_px < record["heldout_px"].get<double>()) record["right"] = false;
  }
  return record;
}

/// Fraction of rooms of each kind for which the generating model is chosen. Two planes count as a profile and as a
/// degenerate quadric, too. A model with more parameters and a worse left-out error is never right. Runs all kinds of
/// one seed, then of the next, so that an interrupted run has equally many of each.
int model(unsigned seeds, Records* records) {
  std::map<RoomKind, std::vector<Json>> by_kind;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    for (const RoomKind kind : kRoomKinds) {
      const auto record =
          records->get(fmt::format("{} {}", name_of(kind), seed), [&] { return choose_one(kind, seed); });
      if (record) by_kind[kind].push_back(*record);
    }
  }
  Json json = Json::object();
  fmt::print("{:<10}{:>7}{:>7}  {}\n", "room", "seeds", "right",
             "chosen; worst held-out px of the chosen, and of the richest tried");
  for (const auto& [kind, of_kind] : by_kind) {
    unsigned right = 0;
    std::map<std::string, int> chosen;
    double heldout = 0.0;
    double richest = 0.0;
    for (const Json& record : of_kind) {
      ++chosen[record.at("chosen")];
      right += record.at("right").get<bool>() ? 1U : 0U;
      heldout = std::max(heldout, record.value("heldout_px", 0.0));
      richest = std::max(richest, record.value("richest_px", 0.0));
    }
    const double fraction = 1.0 * right / static_cast<double>(of_kind.size());
    std::string told;
    for (const auto& [name, count] : chosen) told += fmt::format("{} {}, ", name, count);
    fmt::print("{:<10}{:>7}{:>7.3f}  {}{:.3f}, {:.3f}\n", name_of(kind), of_kind.size(), fraction, told, heldout,
               richest);
    json[name_of(kind)] = {{"right_fraction", rounded(fraction)}, {"seeds", of_kind.size()}};
  }
  fmt::print("{}\n", json.dump());
  return records->exit_code();
}

struct Extreme {
  std::string name;
  RoomPlan plan;
  double bound_px;  ///< Upper bound of the registration's p95; exceeding it is a failure.
};

std::vector<Extreme> extremes(unsigned seeds) {
  std::vector<Extreme> cases;  // All cases of one seed, then of the next.
  const auto add = [&](const std::string& name, const auto& change, double bound_px = 0.6) {
    for (unsigned seed = 1; seed <= seeds; ++seed) {
      RoomPlan plan;
      plan.seed = seed;
      plan.stride_px = 10;
      change(&plan);
      cases.push_back({name, plan, bound_px});
    }
  };
  constexpr double kDegree = std::numbers::pi / 180.0;
  for (const double arc : {2.0, 5.0, 15.0, 45.0, 90.0, 180.0, 270.0, 360.0}) {
    add(fmt::format("arc {} deg", arc), [=](RoomPlan* plan) {
      plan->arc_rad = arc * kDegree;
      plan->projectors = std::clamp(static_cast<int>(std::ceil(arc / 45.0)), 2, 8);
      plan->half_height_m = 4.0 * std::tan(std::min(0.33, 0.4 * plan->arc_rad));
      // If the whole wall fits one picture, directions must still differ; otherwise the axis is undetermined.
      plan->turntable_step_rad = std::min(0.5, std::max(0.05, 0.4 * plan->arc_rad));
    });
  }
  for (const double ratio : {0.25, 0.5, 1.0, 2.0, 4.0, 8.0}) {
    add(fmt::format("throw {}", ratio), [=](RoomPlan* plan) {
      plan->throw_ratio = ratio;
      if (ratio > 2.0) plan->arc_rad = 0.6;
    });
  }
  for (const double incidence : {30.0, 60.0, 75.0, 80.0, 85.0}) {
    add(
        fmt::format("incidence {} deg", incidence),
        [=](RoomPlan* plan) {
          plan->kind = RoomKind::kPlane;
          plan->arc_rad = 0.8;
          plan->throw_ratio = 1.2;
          plan->projectors = 2;
          plan->aim_off_rad = std::tan(incidence * kDegree);
        },
        1.0);
  }
  for (const double overlap : {0.02, 0.05, 0.1, 0.3, 0.6}) {
    add(fmt::format("overlap {}", overlap), [=](RoomPlan* plan) { plan->overlap = overlap; });
  }
  for (const double mm : {0.0, 2.0, 10.0, 25.0, 50.0}) {
    add(fmt::format("nodal offset {} mm", mm), [=](RoomPlan* plan) {
      plan->camera_offset_m = {0.4e-3 * mm, 0.0, 0.9e-3 * mm};
    });
  }
  for (const double step : {1.0, 3.0, 10.0, 20.0, 30.0, 45.0, 60.0, 90.0, 120.0, 180.0}) {
    add(fmt::format("turntable step {} deg", step), [=](RoomPlan* plan) {
      plan->turntable_step_rad = step * kDegree;
      plan->stride_px = step < 5.0 ? 24 : 10;
      if (step < 5.0) plan->arc_rad = 0.6;
    });
  }
  for (const double megapixels : {0.3, 1.0, 5.0, 20.0}) {
    add(fmt::format("camera {} megapixels", megapixels), [=](RoomPlan* plan) {
      plan->camera_megapixels = megapixels;
      plan->noise_px = 0.2 * std::sqrt(2.304 / megapixels);  // Decoding is precise to a fraction of a camera pixel.
    });
  }
  for (const double person : {0.1, 0.3}) {
    add(fmt::format("person of {} rad", person), [=](RoomPlan* plan) { plan->person_rad = person; });
  }
  for (const double noise : {0.02, 0.1, 0.3, 0.6}) {
    add(fmt::format("noise {} px", noise), [=](RoomPlan* plan) { plan->noise_px = noise; });
  }
  for (const double outliers : {0.0, 0.001, 0.01, 0.05}) {
    add(fmt::format("outliers {}", outliers), [=](RoomPlan* plan) { plan->outliers = outliers; });
  }
  std::stable_sort(cases.begin(), cases.end(),
                   [](const Extreme& a, const Extreme& b) { return a.plan.seed < b.plan.seed; });
  return cases;
}

bool is_finite(const calibration::Calibration& calibration) {
  for (const calibration::CalibratedProjector& p : calibration.projectors) {
    for (std::size_t i = 0; i < p.map.directions.size(); ++i) {
      const bool is_none = std::isinf(p.map.sigma_px[i]);  // Marks an absent direction.
      if (!is_none && (!p.map.directions[i].allFinite() || !std::isfinite(p.map.sigma_px[i]))) return false;
    }
  }
  return calibration.turntable.covariance.allFinite() && std::isfinite(calibration.turntable.heldout_rms_px);
}

/// Distance between the maps of two calibrations, in pixels.
double apart_px(const calibration::Calibration& one, const calibration::Calibration& other) {
  double apart = 0.0;
  for (std::size_t p = 0; p < one.projectors.size(); ++p) {
    std::vector<solve::MapSample> samples;
    for (int y = 20; y < GeneratedRoom::kHeight_px; y += 90) {
      for (int x = 20; x < GeneratedRoom::kWidth_px; x += 90) {
        const auto d = other.projectors[p].map.direction_at({x + 0.5, y + 0.5});
        if (d && one.projectors[p].map.direction_at({x + 0.5, y + 0.5}))
          samples.push_back({{x + 0.5, y + 0.5}, *d, 0.1});
      }
    }
    apart = std::max(apart, solve::map_error_px(one.projectors[p].map, samples).value_or(0.0));
  }
  return apart;
}

/// A case must be refused with a remedy, or be within its bound, independent of the starting point and never worse than
/// the previous calibration.
Json push(const Extreme& extreme) {
  Json record{{"failures", Json::array()}};
  const auto fail = [&](const std::string& why) { record["failures"].push_back(why); };
  const GeneratedRoom room(extreme.plan);
  const solve::Measurements measurements = room.measurements();
  solve::CalibrateOptions options;
  options.with_wall = false;
  const auto calibration = solve::calibrate(measurements, "2026-01-01T00-00-00Z", options);
  if (!calibration) {
    const std::string& why = calibration.error().message();
    record["refused"] = why;
    if (why.find("; ") == std::string::npos) fail("refused without a remedy: " + why);
    return record;
  }
  if (!is_finite(*calibration)) fail("a number that is none");
  const RegistrationScore score = score_of(room, *calibration);
  options.turntable.start = {0.05, -0.04, 0.01, -0.01};
  const auto restarted = solve::calibrate(measurements, "2026-01-01T00-00-00Z", options);
  const double restart_px = restarted ? apart_px(*calibration, *restarted) : 1e9;  // JSON has no infinity.
  record.update({{"mean_px", score.mean_px},
                 {"p95_px", score.p95_px},
                 {"max_px", score.max_px},
                 {"true_p95_px", score.true_p95_px},
                 {"restart_px", restart_px},
                 {"places", score.correspondences}});
  if (!(score.p95_px <= extreme.bound_px))
    fail(fmt::format("p95 is {:.3f} px, at most {}", score.p95_px, extreme.bound_px));
  if (!(restart_px <= 0.05)) fail(fmt::format("another start ends {:.3f} px away", restart_px));
  // Noisier measurements of the same room must not replace a better map.
  RoomPlan noisier = extreme.plan;
  noisier.noise_px = 3.0 * extreme.plan.noise_px + 1.0;
  solve::CalibrateOptions again;
  again.with_wall = false;
  again.previous = &*calibration;
  const auto later = solve::calibrate(GeneratedRoom(noisier).measurements(), "2026-01-02T00-00-00Z", again);
  if (!later) return record;
  const RegistrationScore after = score_of(room, *later);
  record["after_noise_p95_px"] = after.p95_px;
  record["after_noise_remarks"] = later->remarks;
  record["after_noise_true_p95_px"] = after.true_p95_px;
  if (!(after.p95_px <= std::max(extreme.bound_px, 1.2 * score.p95_px))) {
    fail(fmt::format("a noisy calibration took p95 from {:.3f} to {:.3f} px", score.p95_px, after.p95_px));
  }
  return record;
}

int sweep(unsigned seeds, Records* records) {
  int cases = 0;
  int refused = 0;
  int failures = 0;
  fmt::print("{:<24}{:>5}{:>9}{:>9}{:>9}{:>10}{:>10}{:>10}{:>12}\n", "case", "seed", "mean", "p95", "max", "true p95",
             "restart", "places", "after noise");
  for (const Extreme& extreme : extremes(seeds)) {
    const auto record =
        records->get(fmt::format("{} seed {}", extreme.name, extreme.plan.seed), [&] { return push(extreme); });
    if (!record) continue;
    ++cases;
    if (record->contains("refused")) {
      ++refused;
      fmt::print("{:<24}{:>5}  refused: {}\n", extreme.name, extreme.plan.seed,
                 record->at("refused").get<std::string>());
    } else {
      fmt::print("{:<24}{:>5}{:>9.3f}{:>9.3f}{:>9.3f}{:>10.3f}{:>10.5f}{:>10}{:>12.3f}\n", extreme.name,
                 extreme.plan.seed, record->value("mean_px", 0.0), record->value("p95_px", 0.0),
                 record->value("max_px", 0.0), record->value("true_p95_px", 0.0), record->value("restart_px", 0.0),
                 record->value("places", 0), record->value("after_noise_p95_px", 0.0));
    }
    for (const Json& why : record->at("failures")) {
      ++failures;
      fmt::print("{:<24}{:>5}  FAILED: {}\n", extreme.name, extreme.plan.seed, why.get<std::string>());
    }
    std::fflush(stdout);
  }
  fmt::print("{}\n", Json({{"cases", cases}, {"refused", refused}, {"failures", failures}}).dump());
  return records->exit_code();
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  unsigned seeds = 1;
  cyclorama::Records::Options options;
  bool is_right = true;
  for (int i = 2; i < argc; ++i) {
    const std::string word = argv[i];
    const bool has_value = i + 1 < argc;
    if (word == "--records" && has_value) {
      options.file = argv[++i];
    } else if (word == "--seconds" && has_value) {
      options.seconds = std::strtod(argv[++i], nullptr);
    } else if (word == "--only" && has_value) {
      options.only = argv[++i];
    } else {
      seeds = static_cast<unsigned>(std::strtoul(word.c_str(), nullptr, 10));
      is_right = is_right && seeds > 0;
    }
  }
  cyclorama::Records records(options);
  if (what == "registration" && is_right) return cyclorama::registration(seeds, &records);
  if (what == "model" && is_right) return cyclorama::model(seeds, &records);
  if (what == "extremes" && is_right) return cyclorama::sweep(seeds, &records);
  fmt::print(stderr,
             "usage: solve_bench registration|model|extremes [SEEDS] [--records FILE] [--seconds S] [--only NAME]\n");
  return 2;
}

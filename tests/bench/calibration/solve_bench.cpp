// SPDX-License-Identifier: Apache-2.0
// Solving what generated rooms measure: solve_bench registration|model|extremes [SEEDS]. Prints a table, then a line of
// JSON.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "appliance/calibrator/solve/calibrate.h"
#include "tests/doubles/generated_room.h"

namespace cyclorama {
namespace {

using Json = nlohmann::ordered_json;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Of this process: the machine may be shared.
double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double rounded(double x) { return std::round(x * 1e4) / 1e4; }

RegistrationScore score_of(const GeneratedRoom& room, const Calibration& calibration) {
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

/// Maps of three and four projectors of 1080p, without the wall's model, and with it for its time.
int registration(unsigned seeds) {
  Json json = Json::object();
  fmt::print("{:<10}{:>5}{:>9}{:>9}{:>9}{:>9}{:>10}{:>9}{:>10}{:>9}{:>9}\n", "room", "proj", "mean", "p95", "max",
             "true p95", "true max", "missing", "measured", "solve s", "cpu s");
  for (const RoomKind kind : kRoomKinds) {
    for (const int projectors : {3, 4}) {
      RegistrationScore worst;
      double mean = 0.0;
      double slowest = 0.0;
      double cpu = 0.0;
      std::size_t measured = 0;
      for (unsigned seed = 1; seed <= seeds; ++seed) {
        RoomPlan plan = plan_of(kind, seed);
        plan.projectors = projectors;
        plan.stride_px = 4;
        const GeneratedRoom room(plan);
        const Measurements measurements = room.measurements();
        for (const auto& direction : measurements.directions) measured += direction.correspondences.size();
        const double cpu_start = cpu_seconds();
        const auto start = std::chrono::steady_clock::now();
        const auto calibration = calibrate(measurements, "2026-01-01T00-00-00Z");
        slowest = std::max(slowest, seconds_since(start));
        cpu = std::max(cpu, cpu_seconds() - cpu_start);
        if (!calibration) {
          fmt::print("{} of seed {}: {}\n", name_of(kind), seed, calibration.error().message());
          worst.max_px = std::numeric_limits<double>::infinity();
          continue;
        }
        const RegistrationScore score = score_of(room, *calibration);
        mean += score.mean_px / seeds;
        worst.p95_px = std::max(worst.p95_px, score.p95_px);
        worst.max_px = std::max(worst.max_px, score.max_px);
        worst.true_p95_px = std::max(worst.true_p95_px, score.true_p95_px);
        worst.true_max_px = std::max(worst.true_max_px, score.true_max_px);
        worst.missing += score.missing;
      }
      fmt::print("{:<10}{:>5}{:>9.3f}{:>9.3f}{:>9.3f}{:>9.3f}{:>10.3f}{:>9}{:>10}{:>9.2f}{:>9.2f}\n", name_of(kind),
                 projectors, mean, worst.p95_px, worst.max_px, worst.true_p95_px, worst.true_max_px, worst.missing,
                 measured / seeds, slowest, cpu);
      std::fflush(stdout);
      json[fmt::format("{} {}", name_of(kind), projectors)] = {{"mean_px", rounded(mean)},
                                                               {"p95_px", rounded(worst.p95_px)},
                                                               {"max_px", rounded(worst.max_px)},
                                                               {"solve_s", rounded(slowest)},
                                                               {"cpu_s", rounded(cpu)},
                                                               {"true_p95_px", rounded(worst.true_p95_px)},
                                                               {"seeds", seeds}};
    }
  }
  fmt::print("{}\n", json.dump());
  return 0;
}

SurfaceRung right_rung(RoomKind kind) {
  switch (kind) {
    case RoomKind::kPlane:
      return SurfaceRung::kPlane;
    case RoomKind::kCylinder:
    case RoomKind::kTiltedCylinder:
      return SurfaceRung::kCylinder;
    case RoomKind::kUnevenCylinder:
    case RoomKind::kCorner:
      return SurfaceRung::kProfile;
    case RoomKind::kDome:
      return SurfaceRung::kQuadric;
    case RoomKind::kBumpy:
      return SurfaceRung::kMesh;
  }
  return SurfaceRung::kPlane;
}

/// How often each kind of room gets the rung that it was made by. Two planes are a profile, and a degenerate quadric
/// too.
int model(unsigned seeds) {
  Json json = Json::object();
  fmt::print("{:<10}{:>7}  {}\n", "room", "right", "chosen; held-out px of the chosen, and of the richest tried");
  for (const RoomKind kind : kRoomKinds) {
    unsigned right = 0;
    std::map<std::string, int> chosen;
    double heldout = 0.0;
    double richest = 0.0;
    for (unsigned seed = 1; seed <= seeds; ++seed) {
      RoomPlan plan = plan_of(kind, seed);
      plan.stride_px = 12;
      const auto calibration = calibrate(GeneratedRoom(plan).measurements(), "2026-01-01T00-00-00Z");
      if (!calibration || !calibration->wall) {
        ++chosen[calibration ? calibration->remarks.back() : calibration.error().message()];
        continue;
      }
      const SurfaceRung rung = calibration->wall->fit.surface.rung;
      ++chosen[std::string(name_of(rung))];
      if (rung == right_rung(kind) || (kind == RoomKind::kCorner && rung == SurfaceRung::kQuadric)) ++right;
      for (const ModelTrial& trial : calibration->wall->surfaces) {
        if (trial.name == name_of(rung)) heldout = std::max(heldout, trial.heldout_rms_px);
      }
      richest = std::max(richest, calibration->wall->surfaces.back().heldout_rms_px);
    }
    std::string told;
    for (const auto& [name, count] : chosen) told += fmt::format("{} {}, ", name, count);
    fmt::print("{:<10}{:>7.3f}  {}{:.3f}, {:.3f}\n", name_of(kind), 1.0 * right / seeds, told, heldout, richest);
    std::fflush(stdout);
    json[name_of(kind)] = {{"right_fraction", rounded(1.0 * right / seeds)}};
  }
  fmt::print("{}\n", json.dump());
  return 0;
}

struct Extreme {
  std::string name;
  RoomPlan plan;
  double bound_px;  ///< On p95 of the registration; beyond that it is a failure.
};

std::vector<Extreme> extremes(unsigned seeds) {
  std::vector<Extreme> cases;
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
      // Where the whole wall fits one picture, directions still differ, or nothing tells the axis.
      plan->plate_step_rad = std::min(0.5, std::max(0.05, 0.4 * plan->arc_rad));
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
    add(fmt::format("plate step {} deg", step), [=](RoomPlan* plan) {
      plan->plate_step_rad = step * kDegree;
      plan->stride_px = step < 5.0 ? 24 : 10;
      if (step < 5.0) plan->arc_rad = 0.6;
    });
  }
  for (const double noise : {0.02, 0.1, 0.3, 0.6}) {
    add(fmt::format("noise {} px", noise), [=](RoomPlan* plan) { plan->noise_px = noise; });
  }
  for (const double outliers : {0.0, 0.001, 0.01, 0.05}) {
    add(fmt::format("outliers {}", outliers), [=](RoomPlan* plan) { plan->outliers = outliers; });
  }
  return cases;
}

bool is_finite(const Calibration& calibration) {
  for (const CalibratedProjector& p : calibration.projectors) {
    for (std::size_t i = 0; i < p.map.directions.size(); ++i) {
      const bool is_none = std::isinf(p.map.sigma_px[i]);  // Says that there is none.
      if (!is_none && (!p.map.directions[i].allFinite() || !std::isfinite(p.map.sigma_px[i]))) return false;
    }
  }
  return calibration.plate.covariance.allFinite() && std::isfinite(calibration.plate.heldout_rms_px);
}

/// Either refused with a remedy, or within its bound, the same from another start, and never worse than before.
int sweep(unsigned seeds) {
  int cases = 0;
  int refused = 0;
  Json failures = Json::array();
  fmt::print("{:<24}{:>5}{:>9}{:>9}{:>9}{:>10}{:>10}\n", "case", "seed", "mean", "p95", "max", "restart", "places");
  for (const Extreme& extreme : extremes(seeds)) {
    ++cases;
    const auto fail = [&](const std::string& why) {
      fmt::print("{:<24}{:>5}  FAILED: {}\n", extreme.name, extreme.plan.seed, why);
      failures.push_back(fmt::format("{} (seed {}): {}", extreme.name, extreme.plan.seed, why));
    };
    const GeneratedRoom room(extreme.plan);
    const Measurements measurements = room.measurements();
    CalibrateOptions options;
    options.with_wall = false;
    const auto calibration = calibrate(measurements, "2026-01-01T00-00-00Z", options);
    if (!calibration) {
      const std::string& why = calibration.error().message();
      if (why.find("; ") == std::string::npos) {
        fail("refused without a remedy: " + why);
      } else {
        ++refused;
        fmt::print("{:<24}{:>5}  refused: {}\n", extreme.name, extreme.plan.seed, why);
      }
      continue;
    }
    if (!is_finite(*calibration)) {
      fail("a number that is none");
      continue;
    }
    const RegistrationScore score = score_of(room, *calibration);
    options.plate.start = {0.05, -0.04, 0.01, -0.01};
    const auto restarted = calibrate(measurements, "2026-01-01T00-00-00Z", options);
    double restart_px = std::numeric_limits<double>::infinity();
    if (restarted) {
      restart_px = 0.0;
      for (std::size_t p = 0; p < room.projectors(); ++p) {
        std::vector<MapSample> samples;
        for (int y = 20; y < GeneratedRoom::kHeight_px; y += 90) {
          for (int x = 20; x < GeneratedRoom::kWidth_px; x += 90) {
            const auto d = restarted->projectors[p].map.direction_at({x + 0.5, y + 0.5});
            if (d && calibration->projectors[p].map.direction_at({x + 0.5, y + 0.5}))
              samples.push_back({{x + 0.5, y + 0.5}, *d, 0.1});
          }
        }
        restart_px = std::max(restart_px, map_error_px(calibration->projectors[p].map, samples).value_or(0.0));
      }
    }
    fmt::print("{:<24}{:>5}{:>9.3f}{:>9.3f}{:>9.3f}{:>10.5f}{:>10}\n", extreme.name, extreme.plan.seed, score.mean_px,
               score.p95_px, score.max_px, restart_px, score.places);
    std::fflush(stdout);
    if (!(score.p95_px <= extreme.bound_px))
      fail(fmt::format("p95 is {:.3f} px, at most {}", score.p95_px, extreme.bound_px));
    if (!(restart_px <= 0.05)) fail(fmt::format("another start ends {:.3f} px away", restart_px));
    // Noisier measurements of the same room must not replace a better map.
    RoomPlan noisier = extreme.plan;
    noisier.noise_px = 3.0 * extreme.plan.noise_px + 1.0;
    CalibrateOptions again;
    again.with_wall = false;
    again.previous = &*calibration;
    const auto later = calibrate(GeneratedRoom(noisier).measurements(), "2026-01-02T00-00-00Z", again);
    if (later) {
      const RegistrationScore after = score_of(room, *later);
      if (!(after.p95_px <= std::max(extreme.bound_px, 1.2 * score.p95_px))) {
        fail(fmt::format("a noisy calibration took p95 from {:.3f} to {:.3f} px", score.p95_px, after.p95_px));
      }
    }
  }
  fmt::print("{}\n", Json({{"cases", cases}, {"refused", refused}, {"failures", failures.size()}}).dump());
  return 0;
}

}  // namespace
}  // namespace cyclorama

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  const auto seeds = static_cast<unsigned>(argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 1);
  if (what == "registration" && seeds > 0) return cyclorama::registration(seeds);
  if (what == "model" && seeds > 0) return cyclorama::model(seeds);
  if (what == "extremes" && seeds > 0) return cyclorama::sweep(seeds);
  fmt::print(stderr, "usage: solve_bench registration|model|extremes [SEEDS]\n");
  return 2;
}

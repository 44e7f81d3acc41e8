// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/shared_farm/fairness.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "tests/bench/shared_farm/shared_farm.h"

namespace cyclorama {
namespace {

constexpr int kNodes = 8;
constexpr int kThreads = 4;
constexpr int kMuseums = 10;
constexpr double kWarmUp = 5.0;
/// Part of its fair share that an honest museum requests.
constexpr double kRequested = 0.9;
constexpr const char* kTenth = "a tenth like the others";

double cost_of(const MuseumDemand& demand) {
  wire::View view;
  view.set_samples(demand.samples);
  view.set_bounces(demand.bounces);
  double seconds = 0.0;
  for (std::uint32_t row = 0; row < demand.height_px / 16; ++row) {
    for (std::uint32_t column = 0; column < demand.width_px / 16; ++column) {
      seconds += cell_seconds(view, static_cast<int>(column), static_cast<int>(row));
    }
  }
  return seconds;
}

/// Pictures of all sizes and qualities, each at the rate that requests kRequested of a fair share.
std::vector<MuseumDemand> honest_museums(int count) {
  std::vector<MuseumDemand> museums;
  for (int i = 0; i < count; ++i) {
    MuseumDemand demand;
    demand.name = "honest " + std::to_string(i + 1);
    demand.width_px = i % 3 == 0 ? 384 : i % 3 == 1 ? 512 : 640;
    demand.height_px = demand.width_px / 2;
    demand.samples = static_cast<std::uint32_t>(1 + i / 6);
    demand.frames_per_second = kRequested * kNodes * kThreads / kMuseums / cost_of(demand);
    demand.from_seconds = 0.037 * i;
    museums.push_back(demand);
  }
  return museums;
}

/// The worst that the wire allows, and what a museum might try to evade its account.
std::vector<MuseumDemand> kinds_of_greed() {
  MuseumDemand largest{.name = "8192x8192, 64 bounces", .frames_per_second = 20.0, .width_px = 8192, .height_px = 8192};
  largest.bounces = 64;
  MuseumDemand finest{.name = "4096 samples of ever new views", .frames_per_second = 100.0};
  finest.samples = 4096;
  finest.bounces = 64;
  MuseumDemand many{.name = "54 sessions", .frames_per_second = 30.0, .samples = 16, .sessions = 54};
  MuseumDemand flooding{.name = "1000 views a second, unanswered", .frames_per_second = 1000.0, .samples = 64};
  flooding.ignores_window = true;
  MuseumDemand coming{.name = "sessions of 0.3 s", .frames_per_second = 50.0, .samples = 256, .sessions = 8};
  coming.session_seconds = 0.3;
  MuseumDemand tiny{
      .name = "16x16 at 1000 views a second", .frames_per_second = 1000.0, .width_px = 16, .height_px = 16};
  tiny.sessions = 16;
  tiny.ignores_window = true;
  return {largest, finest, many, flooding, coming, tiny};
}

struct Outcome {
  std::map<std::string, MuseumService> services;
  double utilisation = 0.0;
  double coordinator_ms_per_frame = 0.0;
};

Outcome simulate(const std::vector<MuseumDemand>& museums, double seconds) {
  SharedFarm farm;
  for (int i = 0; i < kNodes; ++i) farm.add_node(kThreads);
  for (const MuseumDemand& museum : museums) farm.add_museum(museum);
  farm.run(kWarmUp);
  farm.forget_services();
  farm.run(seconds);
  Outcome outcome{farm.services(), farm.busy_seconds() / farm.possible_seconds()};
  int frames = 0;
  for (const auto& [name, service] : outcome.services) frames += service.complete + service.given_up;
  outcome.coordinator_ms_per_frame = 1e3 * farm.coordinator_seconds() / std::max(1, frames);
  return outcome;
}

}  // namespace

bool FairnessCase::is_greedy() const { return greed != kTenth; }

double FairnessCase::share_min() const {
  double min = 1.0;
  for (const HonestMuseum& museum : honest) min = std::min(min, museum.share);
  return min;
}

double FairnessCase::p99_ratio() const {
  double max = 0.0;
  for (const HonestMuseum& museum : honest) max = std::max(max, museum.p99_ratio);
  return max;
}

std::vector<FairnessCase> measure_fairness(double seconds, const std::string& only) {
  const std::vector<MuseumDemand> honest = honest_museums(kMuseums - 1);
  const auto case_of = [&](const std::string& greed, const Outcome& outcome, const Outcome& without) {
    FairnessCase made{greed, {}, outcome.utilisation, outcome.coordinator_ms_per_frame};
    for (const MuseumDemand& demand : honest) {
      const MuseumService& service = outcome.services.at(demand.name);
      const double p99 = service.percentile_ms(0.99);
      const MuseumService& alone = without.services.at(demand.name);
      made.honest.push_back({demand.name, static_cast<double>(service.complete) / std::max(1, alone.complete), p99,
                             p99 / alone.percentile_ms(0.99)});
    }
    return made;
  };
  const Outcome without = simulate(honest, seconds);
  std::vector<FairnessCase> cases{case_of("none", without, without),
                                  case_of(kTenth, simulate(honest_museums(kMuseums), seconds), without)};
  for (const MuseumDemand& greed : kinds_of_greed()) {
    if (greed.name.find(only) == std::string::npos) continue;
    std::vector<MuseumDemand> all = honest;
    all.push_back(greed);
    cases.push_back(case_of(greed.name, simulate(all, seconds), without));
  }
  return cases;
}

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/shared_farm/scale.h"

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "tests/bench/shared_farm/shared_farm.h"

namespace cyclorama {
namespace {

constexpr int kScaleNodes = 64;
constexpr int kScaleThreads = 4;
constexpr int kScaleMuseums = 50;
constexpr int kGreedy = 3;
/// Frames are few and large, as of a wall at high quality, so that an hour can be simulated.
constexpr double kFramesPerSecond = 1.5;
constexpr double kEnough = 0.95;
constexpr double kNodeAway = 30.0;

/// Adds visits of one to five minutes with pauses as long as that.
void add_visits(SharedFarm& farm, const MuseumDemand& museum, double seconds, std::mt19937& random) {
  std::uniform_real_distribution minutes(60.0, 300.0);
  for (double from = minutes(random) - 60.0; from < seconds; from += minutes(random)) {
    MuseumDemand visit = museum;
    visit.from_seconds = from;
    visit.until_seconds = from += minutes(random);
    farm.add_museum(visit);
  }
}

/// One node after the other leaves, for longer than its work takes elsewhere, and another comes.
void add_departures(SharedFarm& farm, double seconds, std::mt19937& random) {
  std::exponential_distribution pause(1.0 / 60.0);
  std::size_t leaving = 0;
  for (double now = 30.0 + pause(random); now < seconds; now += pause(random)) {
    farm.at(now, [&farm, leaving] { farm.remove_node(leaving); });
    farm.at(now + kNodeAway, [&farm] { farm.add_node(kScaleThreads); });
    ++leaving;
  }
}

std::vector<MuseumDemand> greedy_museums() {
  MuseumDemand finest{.name = "greedy 1", .frames_per_second = 2.0, .samples = 4096, .bounces = 64};
  MuseumDemand largest{
      .name = "greedy 2", .frames_per_second = 2.0, .width_px = 4096, .height_px = 4096, .samples = 64};
  MuseumDemand many{.name = "greedy 3", .frames_per_second = 1.0, .samples = 64, .sessions = 4};
  return {finest, largest, many};
}

}  // namespace

ScaleFigures measure_scale(double seconds) {
  SharedFarm farm;
  std::mt19937 random(24);
  for (int i = 0; i < kScaleNodes; ++i) farm.add_node(kScaleThreads);
  std::vector<std::string> honest;
  for (int i = 0; i < kScaleMuseums - kGreedy; ++i) {
    MuseumDemand museum;
    museum.name = honest.emplace_back("honest " + std::to_string(i + 1));
    museum.frames_per_second = kFramesPerSecond;
    museum.width_px = 512;
    museum.height_px = 256;
    museum.samples = static_cast<std::uint32_t>(1 + i % 4);
    add_visits(farm, museum, seconds, random);
  }
  for (const MuseumDemand& museum : greedy_museums()) farm.add_museum(museum);
  add_departures(farm, seconds, random);
  farm.run(seconds);
  ScaleFigures figures{kScaleNodes, farm.nodes_used(), kScaleMuseums};
  std::vector<double> frame_ms;
  for (const auto& [name, service] : farm.services()) {
    figures.frames += service.complete + service.given_up;
    if (std::ranges::find(honest, name) == honest.end()) continue;
    figures.given_up += service.given_up;
    figures.starved += service.complete < kEnough * service.requested ? 1 : 0;
    frame_ms.insert(frame_ms.end(), service.frame_ms.begin(), service.frame_ms.end());
  }
  figures.p99_ms = MuseumService{.frame_ms = std::move(frame_ms)}.percentile_ms(0.99);
  figures.utilisation = farm.busy_seconds() / farm.possible_seconds();
  figures.head_ms_per_frame = 1e3 * farm.coordinator_seconds() / std::max(1, figures.frames);
  return figures;
}

}  // namespace cyclorama

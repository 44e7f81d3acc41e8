// SPDX-License-Identifier: Apache-2.0
/// The walk under extreme hands, timestamps, rates and rooms that no visit has. The shown movement is measured and must
/// stay within the comfort limits.
///
///   walk_extremes [--quick]        prints a table and finally a JSON object: {"cases", "failures", peaks of all}
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "kiosk/tour/navigation/view_meter.h"
#include "tests/data_sets/random_hand.h"

namespace {

using namespace cyclorama;  // NOLINT(google-build-using-namespace)
using namespace std::chrono_literals;
using Eigen::Vector2d;

struct Case {
  std::string name;
  Duration step = 16'666'667ns;
  Duration length = 300s;
  Duration picture = 33ms;
  RandomHand::Habits habits{};
  double scale = 1.0;
  double irregular = 0.0;  ///< Fraction of steps with an arbitrary, even negative, length.
  std::function<void(tour::PoseSeen*)> spoil{};
  bool narrow = false;
};

tour::Site site_of(const Case& at) {
  const auto s = [&](double x, double z) { return Vector2d(at.scale * x, at.scale * z); };
  tour::Site site;
  site.walking_scale = at.scale;
  auto area = at.narrow
                  ? tour::WalkableArea::make({s(-0.1, -3), s(0.1, -3), s(0.1, 0), s(2, 0.1), s(2, 0.3), s(-0.1, 0.2)})
                  : tour::WalkableArea::make({s(-4, -4), s(4, -4), s(4, -0.5), s(6, -0.5), s(6, -3), s(10, -3),
                                              s(10, 3), s(6, 3), s(6, 0.5), s(4, 0.5), s(4, 4), s(-4, 4)},
                                             {{s(-0.5, -2.5), s(0.5, -2.5), s(0.5, -1.5), s(-0.5, -1.5)}});
  CHECK(area);
  site.area = std::make_shared<const tour::WalkableArea>(*std::move(area));
  site.start.position_m = site.area->nearest_allowed(s(0.05, 0.1));
  site.stops = {{"a", site.area->nearest_allowed(s(3, 3)), 0.5}, {"b", site.area->nearest_allowed(s(8, -2)), -2.0}};
  return site;
}

tour::ViewPeaks walk_through(const Case& at) {
  RandomHand hand(11, at.habits);
  tour::NavigationSettings settings;
  settings.guide_after = 3s;
  TimePoint now(1000s);
  tour::VisitWalk walk = tour::after({}, tour::SceneOpened{"x", site_of(at)}, now, settings);
  tour::ViewMeter meter(at.scale);
  Duration until_picture{};
  const TimePoint end = now + at.length;
  while (now < end) {
    Duration step = at.step;
    if (at.irregular > 0.0 && hand.chance(at.irregular)) {
      const double s = std::pow(10.0, -6.0 + 7.0 * hand.uniform());  // A microsecond to ten seconds,
      step = std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 * (hand.chance(0.3) ? -0.1 * s : s)));
    }
    now += step;
    until_picture -= std::max(step, Duration::zero());
    if (until_picture <= Duration::zero()) {
      tour::PoseSeen seen = hand.next(at.picture);
      if (at.spoil) at.spoil(&seen);
      walk = tour::after(std::move(walk), seen, now, settings);
      until_picture = at.picture;
    }
    walk = tour::after(std::move(walk), tour::Tick{}, now, settings);
    const tour::Walker& walker = walk.navigation.walker;
    if (!walk.site.area->allows(walker.position_m)) meter.add({std::nan(""), 0.0}, 0.0, now);
    // Time that stands or runs backwards must not move anything; time that jumps moves at most by kMaxStep.
    meter.add(walker.position_m, walker.heading_rad, now);
  }
  return meter.peaks();
}

/// Longest time from the last picture to rest, over many moments at which the wand is lost.
double max_rest_s(int trials) {
  double longest = 0.0;
  for (int trial = 0; trial < trials; ++trial) {
    RandomHand hand(static_cast<std::uint64_t>(trial), {.shake_m = 0.05, .shake_rad = 0.3, .wild = 6.0, .lost = 0.0});
    tour::NavigationSettings settings;
    settings.guide_after = Duration::zero();
    TimePoint now(100s);
    Case open;
    tour::VisitWalk walk = tour::after({}, tour::SceneOpened{"x", site_of(open)}, now, settings);
    TimePoint seen_at = now;
    for (int i = 0; i < 120 + trial % 60; ++i) {
      now += 16'666'667ns;
      if (i % 2 == 0) {
        walk = tour::after(std::move(walk), hand.next(33ms), now, settings);
        seen_at = walk.navigation.tag_seen_at.value_or(now);
      }
      walk = tour::after(std::move(walk), tour::Tick{}, now, settings);
    }
    // Pictures without a pose count as lost, so after a long wild movement the walk may be at rest already.
    if (walk.navigation.walker.is_at_rest()) continue;
    while (!walk.navigation.walker.is_at_rest() && now < seen_at + 5s) {
      now += 16'666'667ns;
      walk = tour::after(std::move(walk), tour::Tick{}, now, settings);
    }
    longest = std::max(longest, to_seconds(now - seen_at));
  }
  return longest;
}

/// Pose from a camera that is mounted upside down.
void turn_over(tour::PoseSeen* seen) {
  seen->position_m[0] = -seen->position_m[0];
  seen->position_m[1] = -seen->position_m[1];
  const auto [w, x, y, z] = seen->rotation;
  seen->rotation = {-z, -y, x, w};  // A half turn about the camera's axis, applied after the original rotation.
}

}  // namespace

int main(int argc, char** argv) {
  const bool quick = argc > 1 && std::strcmp(argv[1], "--quick") == 0;
  const Duration half_hour = quick ? Duration(180s) : Duration(1800s);
  RandomHand::Habits thrown;
  thrown.wild = 15.0;
  RandomHand::Habits thrown_fast;
  thrown_fast.wild = 300.0;
  RandomHand::Habits odd;
  odd.odd_stamps = true;
  RandomHand::Habits flicker;
  flicker.lost = 6.0;
  std::vector<Case> cases;
  cases.push_back({.name = "a visitor, 60 views a second"});
  cases.push_back({.name = "1000 Hz, pictures and views", .step = 1ms, .length = half_hour, .picture = 1ms});
  cases.push_back({.name = "5 pictures a second", .picture = 200ms});
  cases.push_back({.name = "one picture in two seconds", .picture = 2s});
  cases.push_back({.name = "stamps repeat, jump, go back", .habits = odd});
  cases.push_back({.name = "the clock leaps and runs back", .irregular = 0.05});
  cases.push_back({.name = "wand thrown", .habits = thrown});
  cases.push_back(
      {.name = "wand thrown, at 1000 Hz", .step = 1ms, .length = 120s, .picture = 1ms, .habits = thrown_fast});
  cases.push_back({.name = "lost and found all the time", .habits = flicker});
  cases.push_back({.name = "camera upside down", .spoil = turn_over});
  cases.push_back({.name = "grazing: the pattern at 85 degrees and beyond", .spoil = [](tour::PoseSeen* seen) {
                     seen->rotation = {std::cos(0.742), 0.0, std::copysign(std::sin(0.742), seen->rotation[2]), 0.0};
                   }});
  cases.push_back({.name = "numbers that are none", .spoil = [](tour::PoseSeen* seen) {
                     if (seen->sequence % 3 == 0) seen->position_m[seen->sequence % 2] = std::nan("");
                     if (seen->sequence % 5 == 0) seen->rotation[1] = INFINITY;
                   }});
  cases.push_back({.name = "a relic: steps of millimetres", .scale = 0.001});
  cases.push_back({.name = "a valley: steps of a kilometre", .scale = 1000.0});
  cases.push_back({.name = "a passage as wide as a hand", .narrow = true});
  cases.push_back({.name = "240 views a second", .step = 4'166'667ns});
  cases.push_back({.name = "10 views a second", .step = 100ms});

  int failures = 0;
  tour::ViewPeaks all;
  fmt::print("{:46} {:>8} {:>7} {:>8} {:>9} {:>8} {:>9}  {}\n", "case", "walked m", "m/s", "m/s2", "m/s3", "deg/s",
             "deg/s2", "within");
  constexpr double kDegree = std::numbers::pi / 180.0;
  for (const Case& at : cases) {
    const tour::ViewPeaks peaks = walk_through(at);
    // Computed from differences of positions, so rounding matters where steps are short and rooms are large.
    const bool even = at.irregular == 0.0;
    const bool within =
        peaks.finite && peaks.speed_m_per_s <= tour::kComfort.speed_m_per_s * (1 + 1e-4) &&
        peaks.turn_rad_per_s <= tour::kComfort.turn_rad_per_s * (1 + 1e-6) &&
        (!even || (peaks.acceleration_m_per_s2 <= 1.05 * tour::kComfort.acceleration_m_per_s2 &&
                   peaks.turn_acceleration_rad_per_s2 <= 1.01 * tour::kComfort.turn_acceleration_rad_per_s2));
    failures += within ? 0 : 1;
    all.speed_m_per_s = std::max(all.speed_m_per_s, peaks.speed_m_per_s);
    all.turn_rad_per_s = std::max(all.turn_rad_per_s, peaks.turn_rad_per_s);
    if (even) {
      all.acceleration_m_per_s2 = std::max(all.acceleration_m_per_s2, peaks.acceleration_m_per_s2);
      all.turn_acceleration_rad_per_s2 = std::max(all.turn_acceleration_rad_per_s2, peaks.turn_acceleration_rad_per_s2);
    }
    fmt::print("{:46} {:8.1f} {:7.4f} {:8.3f} {:9.1f} {:8.3f} {:9.1f}  {}\n", at.name, peaks.distance_m,
               peaks.speed_m_per_s, peaks.acceleration_m_per_s2, peaks.jerk_m_per_s3, peaks.turn_rad_per_s / kDegree,
               peaks.turn_acceleration_rad_per_s2 / kDegree, within ? "yes" : "NO");
  }
  const double rest_s = max_rest_s(quick ? 200 : 2000);
  const bool rests = rest_s <= 1.0;
  failures += rests ? 0 : 1;
  fmt::print("{:46} {:.3f} s from the last picture to rest  {}\n", "wand lost, at any moment", rest_s,
             rests ? "yes" : "NO");
  fmt::print(
      "{{\"benchmark\": \"visitor-extremes\", \"part\": \"walk\", \"cases\": {}, \"failures\": {}, \"max_rest_s\": "
      "{:.3f}, \"speed_m_per_s\": {:.4f}, \"turn_deg_per_s\": {:.3f}, \"acceleration_m_per_s2\": {:.3f}, "
      "\"turn_acceleration_deg_per_s2\": {:.2f}}}\n",
      cases.size() + 1, failures, rest_s, all.speed_m_per_s, all.turn_rad_per_s / kDegree, all.acceleration_m_per_s2,
      all.turn_acceleration_rad_per_s2 / kDegree);
  return failures == 0 ? 0 : 1;
}

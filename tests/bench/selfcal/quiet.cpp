// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/bench/selfcal/selfcal_benches.h"

namespace cyclorama {
namespace {

/// The visitor looks about: still, slowly to one side, still, to the other.
double turn_at(int step) {
  constexpr double kTurns[] = {0.0, 0.04, 0.0, -0.03, 0.02, 0.0, -0.05};
  return kTurns[(step / 8) % 7];
}

}  // namespace

int quiet(const ShowContent& content, bool is_quick) {
  // Steps are what costs; the time between them is as in a museum that looks once in so long while nothing happens.
  const int steps = is_quick ? 120 : 1200;
  const Duration period = std::chrono::seconds(20);
  int false_alarms = 0;
  double most_px = 0.0;
  double hours = 0.0;
  std::vector<double> errors;
  for (const std::uint32_t seed : {1u, 2u}) {
    BumpedShowOptions options;
    options.seed = seed;
    if (is_quick) make_small(&options);
    auto made = BumpedShow::make(options, content);
    if (!made) return 1;
    BumpedShow& show = *made;
    // It settles at its usual rate, then time passes quicker.
    for (int i = 0; i < 14; ++i) {
      if (!show.step()) return 1;
    }
    show.set_period(period);
    for (int i = 0; i < steps / 2; ++i) {
      show.set_turn(turn_at(i) * 0.25 / 20.0);
      const auto report = show.step();
      if (!report) return 1;
      false_alarms += static_cast<int>(report->noticed.size());
      for (const Correction& c : report->corrections) most_px = std::max(most_px, c.moved_px);
      for (const std::string& line : report->log) fmt::print(stderr, "{}\n", line);
      for (std::size_t k = 0; k < show.projector_count(); ++k) errors.push_back(show.error_px(k));
      hours += std::chrono::duration<double>(period).count() / 3600.0;
    }
  }
  fmt::print("{} steps: {:.2f} simulated hours; error p50 {:.3f} px, p95 {:.3f} px, most {:.3f} px\n", steps, hours,
             percentile(errors, 0.5), percentile(errors, 0.95), percentile(errors, 1.0));
  fmt::print("{}\n", nlohmann::json{{"hours", hours},
                                    {"steps", steps},
                                    {"false_alarms", false_alarms},
                                    {"max_correction_px", most_px},
                                    {"error_px_p95", percentile(errors, 0.95)}}
                         .dump());
  return 0;
}

int drift(const ShowContent& content, bool is_quick) {
  // A tenth of a pixel a minute, as a lamp that warms up, for so many minutes.
  const int minutes = is_quick ? 10 : 40;
  BumpedShowOptions options;
  if (is_quick) make_small(&options);
  auto made = BumpedShow::make(options, content);
  if (!made) return 1;
  BumpedShow& show = *made;
  for (int i = 0; i < 14; ++i) {
    if (!show.step()) return 1;
  }
  show.set_period(std::chrono::seconds(5));
  std::vector<double> errors;
  int wrong = 0;
  PoseStep creep = PoseStep::Zero();
  creep[1] = 0.1 / 60.0 * 5.0 / show.calibrator().applied().projectors[1].lens.focal_u_px;
  for (int i = 0; i < minutes * 12; ++i) {
    show.bump(1, creep);
    show.set_turn(turn_at(i) * 0.05);
    std::vector<double> before;
    for (std::size_t k = 0; k < show.projector_count(); ++k) before.push_back(show.error_px(k));
    const auto report = show.step();
    if (!report) return 1;
    for (const std::string& line : report->log) fmt::print(stderr, "{}\n", line);
    for (const Correction& c : report->corrections)
      wrong += show.error_px(c.projector) > before[c.projector] + kWrong_px ? 1 : 0;
    errors.push_back(show.error_px(1));
  }
  fmt::print("{} minutes: {:.2f} px in all; error p50 {:.3f} px, p95 {:.3f} px\n", minutes, 0.1 * minutes,
             percentile(errors, 0.5), percentile(errors, 0.95));
  fmt::print("{}\n", nlohmann::json{{"minutes", minutes},
                                    {"drift_px", 0.1 * minutes},
                                    {"error_px_p95", percentile(errors, 0.95)},
                                    {"wrong_corrections", wrong}}
                         .dump());
  return 0;
}

}  // namespace cyclorama

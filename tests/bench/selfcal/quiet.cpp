// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/bench/selfcal/selfcal_benches.h"

namespace cyclorama {
namespace {

using Json = nlohmann::ordered_json;

/// The visitor's heading: still, slowly to one side, still, to the other.
double turn_at(int step) {
  constexpr double kTurns[] = {0.0, 0.04, 0.0, -0.03, 0.02, 0.0, -0.05};
  return kTurns[(step / 8) % 7];
}

/// One hour of a small museum of its own: it settles at its usual rate, then it is observed every `period`.
Result<Json> quiet_hour(const ShowContent& content, std::uint32_t seed, Duration period, int steps) {
  BumpedShowOptions options;
  options.seed = seed;
  make_small(&options);
  TRY_ASSIGN(BumpedShow show, BumpedShow::make(options, content));
  for (int i = 0; i < 14; ++i) TRY(show.step());
  show.set_period(period);
  Json record{{"false_alarms", 0}, {"corrections_px", Json::array()}, {"errors_px", Json::array()}};
  std::size_t alarms = 0;
  const double period_s = std::chrono::duration<double>(period).count();
  for (int i = 0; i < steps; ++i) {
    show.set_turn(turn_at(i) * 0.25 / period_s);
    TRY_ASSIGN(const healing::ShowReport report, show.step());
    alarms += report.noticed.size();
    for (const healing::Correction& c : report.corrections) record["corrections_px"].push_back(c.moved_px);
    for (const std::string& line : report.log) fmt::print(stderr, "{}: {}\n", seed, line);
    for (std::size_t k = 0; k < show.projector_count(); ++k)
      record["errors_px"].push_back(std::round(1e4 * show.error_px(k)) / 1e4);
  }
  record["false_alarms"] = alarms;
  record["hours"] = steps * period_s / 3600.0;
  record["steps"] = steps;
  return record;
}

}  // namespace

int quiet(const ShowContent& content, bool is_quick, const Records::Options& kept) {
  // A day: one hour in each of 24 museums. Steps are the expensive part; the time between them is simulated but not
  // observed.
  const int hours = is_quick ? 2 : 24;
  const Duration period = std::chrono::minutes(1);
  const int steps = static_cast<int>(std::chrono::hours(1) / period);
  Records records(kept);
  std::size_t false_alarms = 0;
  std::vector<double> corrections;
  std::vector<double> errors;
  double simulated_h = 0.0;
  int looked = 0;
  for (int hour = 1; hour <= hours; ++hour) {
    std::string failed;
    const auto record = records.get(fmt::format("quiet {} of {} steps", hour, steps), [&] {
      auto made = quiet_hour(content, static_cast<std::uint32_t>(hour), period, steps);
      if (!made) failed = made.error().message();
      return made ? *std::move(made) : Json();
    });
    if (!failed.empty()) {
      fmt::print(stderr, "selfcal_bench: {}\n", failed);
      return 1;
    }
    if (!record) continue;
    false_alarms += (*record)["false_alarms"].get<std::size_t>();
    for (const auto& px : (*record)["corrections_px"]) corrections.push_back(px);
    for (const auto& px : (*record)["errors_px"]) errors.push_back(px);
    simulated_h += (*record)["hours"].get<double>();
    looked += (*record)["steps"].get<int>();
  }
  fmt::print("{:.2f} simulated hours, {} steps: {} corrections; error p50 {:.3f} px, p95 {:.3f} px, most {:.3f} px\n",
             simulated_h, looked, corrections.size(), percentile(errors, 0.5), percentile(errors, 0.95),
             percentile(errors, 1.0));
  fmt::print("{}\n", Json{{"hours", simulated_h},
                          {"steps", looked},
                          {"false_alarms", false_alarms},
                          {"corrections", corrections.size()},
                          {"max_correction_px", std::max(0.0, percentile(corrections, 1.0))},
                          {"error_px_p95", percentile(errors, 0.95)},
                          {"projector_width_px", 960}}
                         .dump());
  return records.exit_code();
}

int drift(const ShowContent& content, const DriftSeries& series) {
  // A tenth of a pixel a minute, like a lamp that warms up; in steps of a hundredth, so that the simulation is not
  // rebuilt for each observation.
  BumpedShowOptions options;
  if (series.is_small) make_small(&options);
  auto made = BumpedShow::make(options, content);
  if (!made) {
    fmt::print(stderr, "selfcal_bench: {}\n", made.error().message());
    return 1;
  }
  BumpedShow& show = *made;
  for (int i = 0; i < 14; ++i) {
    if (!show.step()) return 1;
  }
  show.set_period(std::chrono::duration_cast<Duration>(std::chrono::duration<double>(1.0 / series.looks_per_s)));
  const int looks_per_step = 6 * series.looks_per_s;
  std::vector<double> errors;
  std::vector<double> others;
  int corrections = 0;
  int wrong = 0;
  calibration::PoseStep creep = calibration::PoseStep::Zero();
  creep[1] = 0.01 / show.calibrator().applied().projectors[1].lens.focal_u_px;
  for (int i = 0; i < series.minutes * 60 * series.looks_per_s; ++i) {
    if (i % looks_per_step == looks_per_step / 2) show.bump(1, creep);
    show.set_turn(turn_at(i / (4 * series.looks_per_s)) * 0.25);
    std::vector<double> before;
    for (std::size_t k = 0; k < show.projector_count(); ++k) before.push_back(show.error_px(k));
    const auto report = show.step();
    if (!report) return 1;
    for (const std::string& line : report->log) fmt::print(stderr, "{}\n", line);
    for (const healing::Correction& c : report->corrections) {
      wrong += show.error_px(c.projector) > before[c.projector] + kWrong_px ? 1 : 0;
      corrections += c.projector == 1 ? 1 : 0;
      fmt::print(stderr, "  off before {:.3f} px, then {:.3f} px\n", before[c.projector], show.error_px(c.projector));
    }
    // Error on the wall until this observation, which came after it was drawn.
    errors.push_back(before[1]);
    for (const std::size_t k : {std::size_t{0}, std::size_t{2}}) others.push_back(show.error_px(k));
    if ((i + 1) % (series.looks_per_s * 60) == 0) {
      fmt::print(stderr, "{} minutes: p95 {:.3f} px, most {:.3f} px\n", (i + 1) / (series.looks_per_s * 60),
                 percentile(errors, 0.95), percentile(errors, 1.0));
    }
  }
  fmt::print("{} minutes: {:.2f} px in all; error p50 {:.3f} px, p95 {:.3f} px, most {:.3f} px; others p95 {:.3f} px\n",
             series.minutes, 0.1 * series.minutes, percentile(errors, 0.5), percentile(errors, 0.95),
             percentile(errors, 1.0), percentile(others, 0.95));
  fmt::print("{}\n", Json{{"minutes", series.minutes},
                          {"drift_px", 0.1 * series.minutes},
                          {"looks_per_s", series.looks_per_s},
                          {"corrections", corrections},
                          {"error_px_p95", percentile(errors, 0.95)},
                          {"error_px_max", percentile(errors, 1.0)},
                          {"others_px_p95", percentile(others, 0.95)},
                          {"projector_width_px", series.is_small ? 960 : 1920},
                          {"wrong_corrections", wrong}}
                         .dump());
  return 0;
}

}  // namespace cyclorama

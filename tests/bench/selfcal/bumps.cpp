// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "drivers/simulated/museum/flaws.h"
#include "tests/bench/selfcal/selfcal_benches.h"

namespace cyclorama {
namespace {

struct Outcome {
  /// Enough of the picture stays on the wall, and the movement is large enough to be visible.
  bool is_in_scope = true;
  double moved_px = 0.0;
  double noticed_s = -1.0;
  double at_2s_px = 0.0;
  double at_5s_px = 0.0;
  int wrong = 0;
  std::vector<double> curve_px;  ///< Error at each step.
};

/// Fraction of a projector's pixels that meet the wall.
double on_wall(const simulated::TrueMuseum& truth, std::size_t projector) {
  const Pinhole& lens = truth.truth().projectors[projector].lens.pinhole();
  int met = 0;
  constexpr int kSide = 16;
  for (int i = 0; i < kSide * kSide; ++i) {
    if (truth.wall_at(projector, (i % kSide + 0.5) / kSide * lens.width_px, (i / kSide + 0.5) / kSide * lens.height_px))
      ++met;
  }
  return static_cast<double>(met) / (kSide * kSide);
}

Result<Outcome> one_bump(const BumpedShowOptions& options, const ShowContent& content, std::uint32_t number,
                         double turn_rad_s, std::string* log) {
  BumpedShowOptions here = options;
  here.turn_rad_s = turn_rad_s;
  TRY_ASSIGN(BumpedShow show, BumpedShow::make(here, content));
  for (int i = 0; i < 14; ++i) {
    TRY_ASSIGN(const healing::ShowReport report, show.step());
    for (const std::string& line : report.log) *log += "  " + line + "\n";
  }
  simulated::RandomStream draws = simulated::RandomStream(number).stream("bump");
  const auto who = static_cast<std::size_t>(draws.between(0.0, static_cast<double>(show.projector_count()) - 1e-9));
  const calibration::PoseStep step = drawn_bump(&draws);
  Outcome outcome;
  const double was_on_wall = on_wall(show.room().truth(), who);
  const double was_px = show.error_px(who);
  show.bump(who, step);
  outcome.moved_px = show.error_px(who);
  outcome.is_in_scope = on_wall(show.room().truth(), who) > 0.7 * was_on_wall;
  *log += fmt::format("bump {}: projector {}, {:.3f} deg, {:.1f} mm, {:.2f} px (was {:.2f})\n", number, who + 1,
                      step.head<3>().norm() * 57.29578, step.tail<3>().norm() * 1e3, outcome.moved_px, was_px);
  const double begun = show.now_s();
  const double period = std::chrono::duration<double>(options.period).count();
  const int steps = static_cast<int>(std::lround(5.0 / period));
  for (int i = 1; i <= steps; ++i) {
    const double before = show.error_px(who);
    outcome.curve_px.push_back(before);
    std::vector<double> errors;
    for (std::size_t k = 0; k < show.projector_count(); ++k) errors.push_back(show.error_px(k));
    TRY_ASSIGN(const healing::ShowReport report, show.step());
    for (const std::string& line : report.log) *log += "  " + line + "\n";
    if (outcome.noticed_s < 0.0 && std::ranges::find(report.noticed, who) != report.noticed.end())
      outcome.noticed_s = show.now_s() - begun;
    for (const healing::Correction& c : report.corrections) {
      if (show.error_px(c.projector) > errors[c.projector] + kWrong_px) ++outcome.wrong;
    }
    if (i == static_cast<int>(std::lround(2.0 / period))) outcome.at_2s_px = before;
  }
  outcome.at_5s_px = show.error_px(who);
  outcome.curve_px.push_back(outcome.at_5s_px);
  return outcome;
}

}  // namespace

void make_small(BumpedShowOptions* options) {
  options->projector_width_px = 960;
  options->projector_height_px = 540;
  options->camera_megapixels = 0.3;
  options->wall_cells = 24;
  options->calibrator.width_px = 632;
}

double percentile(std::vector<double> values, double part) {
  if (values.empty()) return -1.0;
  std::ranges::sort(values);
  const double rank = std::ceil(part * static_cast<double>(values.size())) - 1.0;
  return values[static_cast<std::size_t>(std::clamp(rank, 0.0, static_cast<double>(values.size()) - 1.0))];
}

int bumps(const ShowContent& content, const BumpSeries& series) {
  std::vector<double> noticed;
  std::vector<double> at_2s;
  std::vector<double> at_5s;
  std::vector<std::vector<double>> curves;
  int wrong = 0;
  int beyond = 0;
  int unnoticed = 0;
  fmt::print("{:>4} {:>9} {:>9} {:>9} {:>9} {:>6}\n", "bump", "moved px", "seen s", "2 s px", "5 s px", "wrong");
  for (std::uint32_t number = series.first; number < series.first + series.count; ++number) {
    std::string log;
    BumpedShowOptions options;
    options.seed = 1 + number % 5;
    if (series.is_small) make_small(&options);
    const double turn_rad_s = number % 3 == 0 ? 0.03 : 0.0;
    const auto outcome = one_bump(options, content, number, turn_rad_s, &log);
    if (!outcome) {
      fmt::print(stderr, "selfcal_bench: {}\n", outcome.error().message());
      return 1;
    }
    fmt::print(stderr, "{}", log);
    fmt::print("{:>4} {:>9.2f} {:>9.2f} {:>9.2f} {:>9.2f} {:>6} {}\n", number, outcome->moved_px, outcome->noticed_s,
               outcome->at_2s_px, outcome->at_5s_px, outcome->wrong, outcome->is_in_scope ? "" : "leaves the wall");
    std::fflush(stdout);
    wrong += outcome->wrong;
    if (!outcome->is_in_scope) {
      ++beyond;
      continue;
    }
    // A bump of less than half a pixel need not be detected, but must do no harm.
    if (outcome->moved_px > 1.0) {
      if (outcome->noticed_s < 0.0) ++unnoticed;
      noticed.push_back(outcome->noticed_s < 0.0 ? 5.0 : outcome->noticed_s);
    }
    at_2s.push_back(outcome->at_2s_px);
    at_5s.push_back(outcome->at_5s_px);
    curves.push_back(outcome->curve_px);
  }
  nlohmann::json curve = nlohmann::json::array();
  for (std::size_t i = 0; !curves.empty() && i < curves.front().size(); ++i) {
    std::vector<double> at;
    for (const auto& one : curves) at.push_back(one[i]);
    curve.push_back({percentile(at, 0.5), percentile(at, 0.95)});
  }
  fmt::print("{}\n", nlohmann::json{{"bumps", at_5s.size()},
                                    {"projector_width_px", series.is_small ? 960 : 1920},
                                    {"left_the_wall", beyond},
                                    {"unnoticed", unnoticed},
                                    {"noticed_s_p95", percentile(noticed, 0.95)},
                                    {"px_at_2s_p50", percentile(at_2s, 0.5)},
                                    {"px_at_2s_p95", percentile(at_2s, 0.95)},
                                    {"px_at_5s_p50", percentile(at_5s, 0.5)},
                                    {"px_at_5s_p95", percentile(at_5s, 0.95)},
                                    {"wrong_corrections", wrong},
                                    {"curve_px_p50_p95", curve}}
                         .dump());
  return 0;
}

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "appliance/healing/estimator/patch_observations.h"
#include "tests/bench/selfcal/selfcal_benches.h"

namespace cyclorama {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDrift_s = 12.0;
constexpr double kDrift_px_per_min = 1.5;  // A lamp in its first minutes; a warm one drifts at a tenth of this.
constexpr double kBump_s = 3.0;
constexpr double kHealed_px = 0.3;  // In addition to the error before the bump.
constexpr double kNotHealed_s = 10.0;

/// One value of one parameter.
struct Setting {
  std::string knob;
  double value = 0.0;
  bool is_default = false;
  std::function<void(BumpedShowOptions*)> set;
};

std::vector<Setting> points(bool is_quick) {
  std::vector<Setting> all;
  const auto add = [&](const std::string& knob, double usual, const std::vector<double>& values, const auto& set) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double value = values[i];
      if (is_quick && i % 2 == 1 && value != usual) continue;
      all.push_back({knob, value, value == usual, [set, value](BumpedShowOptions* options) { set(options, value); }});
    }
  };
  add("rate_hz", 4.0, {8.0, 4.0, 2.0, 1.0, 0.5}, [](BumpedShowOptions* o, double hz) {
    o->period = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(1.0 / hz));
  });
  add("patch_step_px", 16.0, {8.0, 11.0, 16.0, 24.0, 32.0, 48.0, 64.0},
      [](BumpedShowOptions* o, double px) { o->calibrator.patches.step_px = static_cast<int>(px); });
  add("patch_radius_px", 10.0, {5.0, 7.0, 10.0, 14.0},
      [](BumpedShowOptions* o, double px) { o->calibrator.patches.radius_px = static_cast<int>(px); });
  add("camera_megapixels", 0.3, {0.05, 0.1, 0.2, 0.3, 0.6}, [](BumpedShowOptions* o, double megapixels) {
    o->camera_megapixels = megapixels;
    o->calibrator.width_px = 4096;  // Wide enough to use all camera pixels.
  });
  add("walk", 1.0, {0.1, 0.3, 1.0, 3.0, 10.0}, [](BumpedShowOptions* o, double times) {
    o->calibrator.walk.turn_rad *= times;
    o->calibrator.walk.shift_m *= times;
  });
  return all;
}

calibration::PoseStep turn_of(BumpedShow& show, std::size_t projector, double px) {
  calibration::PoseStep step = calibration::PoseStep::Zero();
  step[1] = px / show.calibrator().believed().projectors[projector].lens.focal_u_px;
  return step;
}

/// Averaging time of the filter: its variance divided by the variance that a second adds.
double window_s(BumpedShow& show, double sigma_px, const healing::PoseFilter::Walk& walk) {
  const calibration::ShowCalibration& room = show.calibrator().believed();
  calibration::PoseStep each;
  each << Eigen::Vector3d::Constant(walk.turn_rad), Eigen::Vector3d::Constant(walk.shift_m);
  const double second_px =
      healing::pixel_motion(room, room.projectors[1]).sigma_px(calibration::PoseMatrix(each.cwiseAbs2().asDiagonal()));
  return sigma_px * sigma_px / (second_px * second_px);
}

/// One museum: it settles, a projector drifts, then one projector is bumped by 7 px and another by 1 px.
Result<Json> one_case(const BumpedShowOptions& options, const ShowContent& content) {
  TRY_ASSIGN(BumpedShow show, BumpedShow::make(options, content));
  const double period_s = std::chrono::duration<double>(options.period).count();
  for (int i = 0; i < 14 || (!show.calibrator().is_settled() && i < 60); ++i) TRY(show.step());
  Json record{{"wrong", 0}, {"errors_px", Json::array()}, {"healed_s", Json::array()}, {"after_px", Json::array()}};
  int wrong = 0;
  healing::ShowReport report;
  const auto step = [&]() -> Status {
    std::vector<double> before;
    for (std::size_t k = 0; k < show.projector_count(); ++k) before.push_back(show.error_px(k));
    TRY_ASSIGN(report, show.step());
    for (const healing::Correction& c : report.corrections)
      wrong += show.error_px(c.projector) > before[c.projector] + kWrong_px ? 1 : 0;
    return Done{};
  };
  // Twice a second is enough for a drift, except where the rate is the parameter under test.
  const double drift_period_s = period_s == 0.25 ? 0.5 : period_s;
  show.set_period(std::chrono::duration_cast<Duration>(std::chrono::duration<double>(drift_period_s)));
  show.set_turn(0.03);
  double begun = show.calibrator_cpu_s();
  const int drifts = static_cast<int>(std::lround(kDrift_s / drift_period_s));
  for (int i = 0; i < drifts; ++i) {
    show.bump(0, turn_of(show, 0, kDrift_px_per_min / 60.0 * drift_period_s));
    TRY(step());
    for (std::size_t k = 0; k < show.projector_count(); ++k) record["errors_px"].push_back(show.error_px(k));
  }
  record["cpu_ms"] = 1e3 * (show.calibrator_cpu_s() - begun) / drifts;
  record["window_s"] = window_s(show, report.projectors[1].sigma_px, options.calibrator.walk);
  double patches = 0.0;
  for (const healing::CameraObservation& look : show.calibrator().looks())
    patches +=
        static_cast<double>(std::ranges::count(look.patches, healing::PatchFit::kFits, &healing::PatchShift::fit));
  record["patches"] = patches;
  show.set_period(options.period);
  show.set_turn(0.0);
  for (const auto& [who, px] : {std::pair<std::size_t, double>(1, 7.0), std::pair<std::size_t, double>(2, 1.0)}) {
    const double before = show.error_px(who);
    show.bump(who, turn_of(show, who, px));
    const int steps = std::max(4, static_cast<int>(std::lround(kBump_s / period_s)));
    double healed_s = kNotHealed_s;
    for (int i = 1; i <= steps; ++i) {
      TRY(step());
      if (healed_s == kNotHealed_s && show.error_px(who) <= before + kHealed_px) healed_s = i * period_s;
    }
    record["healed_s"].push_back(healed_s);
    record["after_px"].push_back(show.error_px(who));
  }
  record["wrong"] = wrong;
  return record;
}

void append(const Json& from, std::vector<double>* to) {
  for (const auto& value : from) to->push_back(value.get<double>());
}

}  // namespace

int trade(const ShowContent& content, bool is_quick, const Records::Options& options, const std::string& json) {
  Records records(options);
  Json all = Json::array();
  fmt::print("{:<18} {:>7} {:>8} {:>9} {:>8} {:>8} {:>9} {:>9} {:>8} {:>8} {:>6}\n", "knob", "value", "patches",
             "window s", "p50 px", "p95 px", "7 px: s", "1 px: s", "after px", "cores", "wrong");
  for (const Setting& point : points(is_quick)) {
    std::vector<double> errors;
    std::vector<double> after;
    std::vector<double> far;
    std::vector<double> near;
    double patches = 0.0;
    double window = 0.0;
    double cpu_ms = 0.0;
    int wrong = 0;
    int seeds = 0;
    BumpedShowOptions show;
    make_small(&show);
    point.set(&show);
    for (std::uint32_t seed = 1; seed <= (is_quick ? 1u : 2u); ++seed) {
      show.seed = seed;
      std::string failed;
      // The default setting is run only once for all parameters.
      const std::string setting = point.is_default ? "default" : fmt::format("{} {}", point.knob, point.value);
      const auto record = records.get(fmt::format("{} seed {}", setting, seed), [&] {
        auto made = one_case(show, content);
        if (!made) failed = made.error().message();
        return made ? *std::move(made) : Json();
      });
      if (!failed.empty()) {
        fmt::print(stderr, "selfcal_bench: {}\n", failed);
        return 1;
      }
      if (!record) continue;
      append((*record)["errors_px"], &errors);
      append((*record)["after_px"], &after);
      far.push_back((*record)["healed_s"][0]);
      near.push_back((*record)["healed_s"][1]);
      patches += (*record)["patches"].get<double>();
      window += (*record)["window_s"].get<double>();
      cpu_ms += (*record)["cpu_ms"].get<double>();
      wrong += (*record)["wrong"].get<int>();
      ++seeds;
    }
    if (seeds == 0) continue;
    const double hz = 1.0 / std::chrono::duration<double>(show.period).count();
    const Json made{{"knob", point.knob},
                    {"value", point.value},
                    {"default", point.is_default},
                    {"patches", patches / seeds},
                    {"window_s", window / seeds},
                    {"p50_px", percentile(errors, 0.5)},
                    {"p95_px", percentile(errors, 0.95)},
                    {"far_healed_s", percentile(far, 1.0)},
                    {"near_healed_s", percentile(near, 1.0)},
                    {"after_px", percentile(after, 1.0)},
                    {"cpu_ms", cpu_ms / seeds},
                    {"cores", 1e-3 * hz * cpu_ms / seeds},
                    {"wrong", wrong}};
    fmt::print("{:<18} {:>7.3g} {:>8.0f} {:>9.2f} {:>8.3f} {:>8.3f} {:>9.2f} {:>9.2f} {:>8.3f} {:>8.3f} {:>6}{}\n",
               point.knob, point.value, made["patches"].get<double>(), made["window_s"].get<double>(),
               made["p50_px"].get<double>(), made["p95_px"].get<double>(), made["far_healed_s"].get<double>(),
               made["near_healed_s"].get<double>(), made["after_px"].get<double>(), made["cores"].get<double>(), wrong,
               point.is_default ? "  default" : "");
    std::fflush(stdout);
    all.push_back(made);
  }
  if (!json.empty()) std::ofstream(json) << all.dump() << "\n";
  return records.exit_code();
}

}  // namespace cyclorama

// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <functional>
#include <memory>

#include "tests/bench/selfcal/selfcal_benches.h"

namespace cyclorama {
namespace {

constexpr double kHealed_px = 1.0;
constexpr double kSteady_px = 0.5;  // For projectors that are not bumped.

struct Case {
  std::string name;
  std::function<void(BumpedShowOptions*)> set;
  std::function<void(BumpedShow*)> begin;  ///< Called once the calibration has settled.
  bool may_hold = false;                   ///< Correction is not required, but a reason and no harm are.
};

ShowContent darker(const ShowContent& content, double times) {
  ShowContent made = content;
  for (std::uint8_t& code : made.picture.data()) code = static_cast<std::uint8_t>(code * times);
  return made;
}

/// Delays the reports of shown pictures by one step.
std::function<void(healing::ShowMoment*)> late() {
  auto waiting = std::make_shared<healing::ShowMoment>();
  return [waiting](healing::ShowMoment* moment) {
    std::swap(waiting->shown, moment->shown);
    std::swap(waiting->until, moment->until);
  };
}

/// Repeats earlier reports, and duplicates photographs.
std::function<void(healing::ShowMoment*)> repeated() {
  auto before = std::make_shared<healing::ShowMoment>();
  return [before](healing::ShowMoment* moment) {
    const healing::ShowMoment now = *moment;
    moment->shown.insert(moment->shown.end(), before->shown.begin(), before->shown.end());
    moment->shown.insert(moment->shown.end(), now.shown.begin(), now.shown.end());
    if (!before->seen.empty()) moment->seen.push_back(before->seen.front());
    *before = now;
  };
}

/// Drops every fourth report, which leaves a gap in the numbers.
std::function<void(healing::ShowMoment*)> missing() {
  auto count = std::make_shared<int>(0);
  return [count](healing::ShowMoment* moment) {
    std::erase_if(moment->shown, [&](const healing::ShownPicture&) { return ++*count % 4 == 0; });
  };
}

/// Puts the cameras' clock behind that of the displays.
std::function<void(healing::ShowMoment*)> behind(Duration by) {
  return [by](healing::ShowMoment* moment) {
    for (healing::CameraPicture& seen : moment->seen) {
      seen.opened -= by;
      seen.closed -= by;
    }
  };
}

std::vector<Case> cases(const ShowContent& content) {
  const auto told = [](const std::function<std::function<void(healing::ShowMoment*)>()>& teller) {
    return [teller](BumpedShow* show) {
      show->set_turn(0.03);
      show->set_teller(teller());
    };
  };
  const auto nothing = [](BumpedShow*) {};
  const auto usual = [](BumpedShowOptions*) {};
  std::vector<Case> all;
  for (const double field_deg : {40.0, 26.0}) {
    all.push_back({fmt::format("cameras of {:.0f} degrees: short arcs", field_deg),
                   [field_deg](BumpedShowOptions* o) { o->camera_field_deg = field_deg; }, nothing, field_deg < 30.0});
  }
  all.push_back({"a flat wall", [](BumpedShowOptions* o) { o->museum = "plane"; }, nothing});
  all.push_back({"cameras 50 mm apart", [](BumpedShowOptions* o) { o->camera_apart_m = 0.05; }, nothing});
  all.push_back({"cameras 1 mm apart", [](BumpedShowOptions* o) { o->camera_apart_m = 0.001; }, nothing});
  for (const double times : {0.5, 0.25}) {
    all.push_back({fmt::format("codes times {}, an eighth of the exposure", times),
                   [](BumpedShowOptions* o) { o->exposure_s = 0.005; },
                   [&content, times](BumpedShow* show) { show->set_content(darker(content, times)); }, true});
  }
  all.push_back({"reports late by a step", usual, told(late), true});
  all.push_back({"reports and photographs twice", usual, told(repeated)});
  all.push_back({"a quarter of the reports missing", usual, told(missing), true});
  all.push_back({"cameras' clock behind by 30 ms", usual, told([] { return behind(std::chrono::milliseconds(30)); })});
  all.push_back({"cameras' clock behind by 2 s", usual, told([] { return behind(std::chrono::seconds(2)); }), true});
  return all;
}

struct Outcome {
  double worst_px = 0.0;  ///< Largest error of the projectors that are not bumped.
  double bumped_px = 0.0;
  double after_px = 0.0;
  int wrong = 0;
  int corrections = 0;
  std::size_t edges = 0;
  std::string reason;
};

Result<Outcome> run(const Case& one, const ShowContent& content) {
  BumpedShowOptions options;
  make_small(&options);
  one.set(&options);
  TRY_ASSIGN(BumpedShow show, BumpedShow::make(options, content));
  Outcome outcome;
  const auto steps = [&](int count) -> Status {
    for (int i = 0; i < count; ++i) {
      std::vector<double> before;
      for (std::size_t k = 0; k < show.projector_count(); ++k) before.push_back(show.error_px(k));
      TRY_ASSIGN(const healing::ShowReport report, show.step());
      for (const std::string& line : report.log) fmt::print(stderr, "{}: {}\n", one.name, line);
      for (const healing::Correction& c : report.corrections) {
        ++outcome.corrections;
        outcome.wrong += show.error_px(c.projector) > before[c.projector] + kWrong_px ? 1 : 0;
      }
      for (const std::size_t k : {std::size_t{0}, std::size_t{2}})
        outcome.worst_px = std::max(outcome.worst_px, show.error_px(k));
      outcome.reason = report.projectors[1].reason;
    }
    return Done{};
  };
  TRY(steps(14));
  one.begin(&show);
  TRY(steps(8));
  calibration::PoseStep bump = calibration::PoseStep::Zero();
  bump[1] = 0.006;
  bump[3] = 0.004;
  show.bump(1, bump);
  outcome.bumped_px = show.error_px(1);
  TRY(steps(16));
  outcome.after_px = show.error_px(1);
  for (const healing::CameraObservation& look : show.calibrator().looks()) outcome.edges += look.edges.size();
  return outcome;
}

}  // namespace

std::optional<Extremes> room_extremes(const ShowContent& content) {
  Extremes sum;
  fmt::print("{:<44} {:>7} {:>10} {:>9} {:>11} {:>6}\n", "room", "edges", "bumped px", "after px", "others, px",
             "wrong");
  for (const Case& one : cases(content)) {
    const auto outcome = run(one, content);
    if (!outcome) {
      fmt::print(stderr, "selfcal_bench: {}: {}\n", one.name, outcome.error().message());
      return std::nullopt;
    }
    const bool is_healed = outcome->after_px <= kHealed_px;
    const bool is_held =
        one.may_hold && !outcome->reason.empty() && outcome->after_px <= outcome->bumped_px + kSteady_px;
    const bool is_good = outcome->wrong == 0 && outcome->worst_px <= kSteady_px && (is_healed || is_held);
    ++sum.cases;
    sum.failures += is_good ? 0 : 1;
    fmt::print("{:<44} {:>7} {:>10.2f} {:>9.2f} {:>11.2f} {:>6}{}{}\n", one.name, outcome->edges, outcome->bumped_px,
               outcome->after_px, outcome->worst_px, outcome->wrong, is_good ? "" : "  FAILED",
               outcome->reason.empty() ? "" : "  " + outcome->reason);
    std::fflush(stdout);
  }
  return sum;
}

}  // namespace cyclorama

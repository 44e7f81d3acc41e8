// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "drivers/simulated/museum/flaws.h"
#include "tests/bench/selfcal/selfcal_benches.h"

namespace cyclorama {
namespace {

struct Case {
  std::string name;
  /// Called before each step, counted from 0.
  std::function<void(BumpedShow*, int)> before;
  bool has_to_hold = false;  ///< All projectors must be right at the end.
  int bumped = -1;           ///< Projector that is bumped in the middle of the case.
};

ShowContent plain_content(std::uint8_t code) {
  ShowContent made = painted_content(512, 1);
  std::ranges::fill(made.picture.data(), code);
  return made;
}

ShowContent striped_content() {
  ShowContent made = painted_content(6144, 1);
  for (int y = 0; y < made.picture.height(); ++y) {
    for (int x = 0; x < made.picture.width(); ++x) {
      const bool is_light = (x / 24 + y / 24) % 2 == 0;
      std::fill_n(made.picture.at(x, y), 3, static_cast<std::uint8_t>(is_light ? 170 : 40));
    }
  }
  return made;
}

std::vector<simulated::Visitor> walking(int people, int step) {
  std::vector<simulated::Visitor> all;
  for (int i = 0; i < people; ++i) {
    const double angle = -0.9 + 1.8 * i / std::max(people - 1, 1) + 0.04 * step * (i % 2 == 0 ? 1.0 : -1.0);
    const double distance = 2.2 + 0.35 * (i % 3);
    all.push_back({distance * std::sin(angle), -distance * std::cos(angle), 0.22 + 0.03 * (i % 3), 1.6 + 0.1 * (i % 4),
                   0.15 + 0.15 * (i % 3)});
  }
  return all;
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const int people : {1, 2, 4, 6}) {
    all.push_back({fmt::format("{} people walk", people),
                   [people](BumpedShow* show, int i) { show->room().set_visitors(walking(people, i)); }});
    all.push_back({fmt::format("{} people stand", people),
                   [people](BumpedShow* show, int) { show->room().set_visitors(walking(people, 3)); }});
    all.push_back({fmt::format("{} people walk, and a bump", people),
                   [people](BumpedShow* show, int i) { show->room().set_visitors(walking(people, i)); }, false, 1});
  }
  all.push_back({"somebody before a camera", [](BumpedShow* show, int) {
                   const Point<frame::Camera> before{Eigen::Vector3d(0.25, 0.0, 0.9)};
                   const Eigen::Vector3d at = (show->room().cameras()[1].T_room_camera * before).xyz;
                   show->room().set_visitors({{at.x(), at.z(), 0.2, 3.0, 0.3}});
                 }});
  all.push_back({"black", [](BumpedShow* show, int) { show->set_content(plain_content(0)); }, true});
  all.push_back({"plain grey", [](BumpedShow* show, int) { show->set_content(plain_content(120)); }});
  all.push_back({"chequers", [](BumpedShow* show, int) { show->set_content(striped_content()); }});
  all.push_back(
      {"chequers, and a bump", [](BumpedShow* show, int) { show->set_content(striped_content()); }, false, 1});
  all.push_back(
      {"lights on", [](BumpedShow* show, int i) {
         show->room().set_ambient(i % 8 < 4 ? simulated::RoomColour{60, 60, 55} : simulated::RoomColour{2, 2, 2});
       }});
  all.push_back({"lights on, and a bump",
                 [](BumpedShow* show, int) {
                   show->room().set_ambient({60, 60, 55});
                 },
                 false, 1});
  all.push_back({"a lamp off and on", [](BumpedShow* show, int i) { show->set_lamp(2, i < 3 || i > 8); }});
  return all;
}

}  // namespace

int occlusion(const ShowContent& content, bool is_quick, std::size_t first) {
  int wrong = 0;
  int held = 0;
  int had_to_hold = 0;
  int recovered = 0;
  int had_to_recover = 0;
  int count = 0;
  fmt::print("{:<28} {:>11} {:>6} {:>10} {:>10}  held because\n", "case", "corrections", "wrong", "worst px",
             "after px");
  const std::vector<Case> all = cases();
  for (std::size_t i = first; i < all.size(); i += is_quick ? 2 : 1) {
    const Case& one = all[i];
    BumpedShowOptions options;
    options.seed = 1 + static_cast<std::uint32_t>(i % 3);
    if (is_quick) make_small(&options);
    auto made = BumpedShow::make(options, content);
    if (!made) return 1;
    BumpedShow& show = *made;
    for (int k = 0; k < 14; ++k) {
      if (!show.step()) return 1;
    }
    int corrections = 0;
    int wrong_here = 0;
    double worst = 0.0;
    std::string why;
    const auto run = [&](int steps, bool is_free) {
      for (int k = 0; k < steps; ++k) {
        if (!is_free) one.before(&show, k);
        if (!is_free && k == 5 && one.bumped >= 0) {
          calibration::PoseStep step = calibration::PoseStep::Zero();
          step[1] = 0.006;
          step[3] = 0.01;
          show.bump(static_cast<std::size_t>(one.bumped), step);
        }
        std::vector<double> before;
        for (std::size_t p = 0; p < show.projector_count(); ++p) before.push_back(show.error_px(p));
        const auto report = show.step();
        if (!report) return false;
        for (const std::string& line : report->log) fmt::print(stderr, "{}: {}\n", one.name, line);
        for (const healing::Correction& c : report->corrections) {
          ++corrections;
          if (show.error_px(c.projector) > before[c.projector] + kWrong_px) ++wrong_here;
        }
        for (std::size_t p = 0; p < show.projector_count(); ++p) {
          if (static_cast<int>(p) != one.bumped) worst = std::max(worst, show.error_px(p));
          if (!is_free && !report->projectors[p].reason.empty()) why = report->projectors[p].reason;
        }
      }
      return true;
    };
    if (!run(16, false)) return 1;
    const bool is_held = !why.empty() && corrections == 0;
    // Removes the visitors: the room is as before.
    show.room().set_visitors({});
    show.room().set_ambient(show.room().truth().truth().ambient_lux);
    show.set_content(content);
    for (std::size_t p = 0; p < show.projector_count(); ++p) show.set_lamp(p, true);
    if (!run(10, true)) return 1;
    double after = 0.0;
    for (std::size_t p = 0; p < show.projector_count(); ++p) after = std::max(after, show.error_px(p));
    ++count;
    wrong += wrong_here;
    if (one.has_to_hold) {
      ++had_to_hold;
      held += is_held ? 1 : 0;
    }
    if (one.bumped >= 0) {
      ++had_to_recover;
      recovered += after <= 1.0 ? 1 : 0;
    }
    fmt::print("{:<28} {:>11} {:>6} {:>10.2f} {:>10.2f}  {}\n", one.name, corrections, wrong_here, worst, after, why);
    std::fflush(stdout);
  }
  fmt::print("{}\n", nlohmann::json{{"cases", count},
                                    {"wrong_corrections", wrong},
                                    {"had_to_hold", had_to_hold},
                                    {"held", held},
                                    {"bumps", had_to_recover},
                                    {"recovered", recovered}}
                         .dump());
  return 0;
}

}  // namespace cyclorama

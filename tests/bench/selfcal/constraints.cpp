// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "tests/bench/selfcal/selfcal_benches.h"

namespace cyclorama {
namespace {

/// A plain wall with a spot of the picture every ten degrees: about a fifteenth of it has features.
ShowContent few_features(const ShowContent& content) {
  constexpr double kApart_rad = 0.17;
  constexpr double kRadius_rad = 0.02;
  constexpr float kPlain = 90.0f;
  ShowContent made = content;
  const double per_px = 2.0 * std::numbers::pi / made.shape.width_px;
  for (int y = 0; y < made.picture.height(); ++y) {
    for (int x = 0; x < made.picture.width(); ++x) {
      const double across = std::remainder(x * per_px, kApart_rad);
      const double down = std::remainder(y * per_px, kApart_rad);
      const double off = std::hypot(across, down) / kRadius_rad;
      // A smooth fade, without an edge of its own.
      const auto share = static_cast<float>(off < 1.0 ? (1.0 - off * off) * (1.0 - off * off) : 0.0);
      std::uint8_t* code = made.picture.at(x, y);
      for (int c = 0; c < 3; ++c)
        code[c] = static_cast<std::uint8_t>(kPlain + share * (static_cast<float>(code[c]) - kPlain) + 0.5f);
    }
  }
  return made;
}

}  // namespace

/// Gain of each constraint: bumps cameras and a projector, then measures the picture's error, with features all over
/// the picture and with few.
int constraints(const ShowContent& content, bool is_quick) {
  struct Set {
    const char* name;
    bool arcs;
    bool sides;
  };
  nlohmann::json all;
  const ShowContent few = few_features(content);
  fmt::print("{:<40} {:>9} {:>9} {:>9}\n", "constraints", "p50 px", "p95 px", "worst px");
  for (const bool is_few : {true, false}) {
    for (const Set& set : {Set{"reprojection", false, false}, Set{"reprojection, arcs", true, false},
                           Set{"reprojection, sides", false, true}, Set{"reprojection, arcs, sides", true, true}}) {
      std::vector<double> errors;
      for (std::uint32_t seed = 1; seed <= (is_quick ? 2u : 6u); ++seed) {
        BumpedShowOptions options;
        options.seed = seed;
        if (is_quick) make_small(&options);
        options.calibrator.uses_arcs = set.arcs;
        options.calibrator.uses_sides = set.sides;
        auto made = BumpedShow::make(options, is_few ? few : content);
        if (!made) return 1;
        BumpedShow& show = *made;
        for (int i = 0; i < 14; ++i) {
          if (!show.step()) return 1;
        }
        simulated::RandomStream draws = simulated::RandomStream(seed).stream("constraints");
        for (std::size_t c = 0; c < 3; ++c) {
          calibration::PoseStep step;
          for (int i = 0; i < 6; ++i) step[i] = draws.about_zero(i < 3 ? 0.004 : 0.005);
          if (c == 1) {
            show.bump(1, step);
          } else {
            show.bump_camera(c, step);
          }
          for (int i = 0; i < 8; ++i) {
            const auto report = show.step();
            if (!report) return 1;
            for (const std::string& line : report->log) fmt::print(stderr, "{}\n", line);
          }
          for (std::size_t p = 0; p < show.projector_count(); ++p) errors.push_back(show.error_px(p));
        }
      }
      const std::string name = std::string(is_few ? "few features: " : "") + set.name;
      fmt::print("{:<40} {:>9.3f} {:>9.3f} {:>9.3f}\n", name, percentile(errors, 0.5), percentile(errors, 0.95),
                 percentile(errors, 1.0));
      std::fflush(stdout);
      all[name] = percentile(errors, 0.95);
    }
  }
  fmt::print("{}\n", all.dump());
  return 0;
}

}  // namespace cyclorama

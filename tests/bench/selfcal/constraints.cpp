// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/bench/selfcal/selfcal_benches.h"

namespace cyclorama {

/// What each constraint is worth: cameras and a projector are bumped, and the picture's error is asked for afterwards.
int constraints(const ShowContent& content, bool is_quick) {
  struct Set {
    const char* name;
    bool arcs;
    bool sides;
  };
  nlohmann::json all;
  fmt::print("{:<40} {:>9} {:>9} {:>9}\n", "constraints", "p50 px", "p95 px", "worst px");
  for (const Set& set : {Set{"reprojection", false, false}, Set{"reprojection, arcs", true, false},
                         Set{"reprojection, sides", false, true}, Set{"reprojection, arcs, sides", true, true}}) {
    std::vector<double> errors;
    for (std::uint32_t seed = 1; seed <= (is_quick ? 2u : 6u); ++seed) {
      BumpedShowOptions options;
      options.seed = seed;
      if (is_quick) make_small(&options);
      options.calibrator.uses_arcs = set.arcs;
      options.calibrator.uses_sides = set.sides;
      auto made = BumpedShow::make(options, content);
      if (!made) return 1;
      BumpedShow& show = *made;
      for (int i = 0; i < 14; ++i) {
        if (!show.step()) return 1;
      }
      Draws draws = Draws(seed).stream("constraints");
      for (std::size_t c = 0; c < 3; ++c) {
        PoseStep step;
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
    fmt::print("{:<40} {:>9.3f} {:>9.3f} {:>9.3f}\n", set.name, percentile(errors, 0.5), percentile(errors, 0.95),
               percentile(errors, 1.0));
    std::fflush(stdout);
    all[set.name] = percentile(errors, 0.95);
  }
  fmt::print("{}\n", all.dump());
  return 0;
}

}  // namespace cyclorama

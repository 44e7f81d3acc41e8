// SPDX-License-Identifier: Apache-2.0
/// A visitor's movements before a camera, as functions of time, with changing surroundings: for tests and figures.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "tests/data_sets/rendered_visitor.h"

namespace cyclorama {

/// Rises smoothly from 0 at `from` to 1 at `to`.
inline double eased(double t, double from, double to) {
  const double u = std::clamp((t - from) / (to - from), 0.0, 1.0);
  return u * u * (3.0 - 2.0 * u);
}

/// Comes in from the side at 2 s, stands at the mark from 4 s on, with the small movements of a standing person, and
/// from 7 s on steps aside, near, back, and leans; ends at the starting position at 19 s. The mark is 2 m away.
struct SteeringVisitor {
  RenderedVisitor looks{};
  double mark_x_m = 0.05;  ///< Nobody stands exactly on a mark.
  double mark_depth_m = 2.03;
  double leaves_at_s = 1e9;

  [[nodiscard]] RenderedVisitor at(double t) const {
    RenderedVisitor v = looks;
    const double walk_in = eased(t, 2.0, 4.0), walk_out = eased(t, leaves_at_s, leaves_at_s + 1.5);
    v.x_m =
        mark_x_m - 2.4 * (1.0 - walk_in) + 2.6 * walk_out + 0.004 * std::sin(1.9 * t) + 0.003 * std::sin(4.3 * t + 1.0);
    v.depth_m = mark_depth_m + 0.004 * std::sin(1.3 * t + 0.4);
    v.lean_rad = 0.006 * std::sin(1.1 * t);
    v.x_m += 0.40 * (eased(t, 7.0, 7.8) - eased(t, 8.6, 9.4)) - 0.40 * (eased(t, 9.4, 10.2) - eased(t, 11.0, 11.8));
    v.depth_m += 0.45 * (eased(t, 12.0, 13.0) - eased(t, 13.6, 14.6));
    v.depth_m -= 0.45 * (eased(t, 14.6, 15.4) - eased(t, 15.8, 16.6));
    v.lean_rad +=
        0.30 * (eased(t, 16.6, 17.2) - eased(t, 17.5, 18.0)) - 0.30 * (eased(t, 18.0, 18.5) - eased(t, 18.7, 19.0));
    v.arms_rad = 0.12 + 0.06 * std::sin(0.9 * t);
    return v;
  }
};

/// One case: visitors and lighting as functions of time.
struct VisitorStory {
  std::string name;
  SteeringVisitor visitor{};
  std::function<std::vector<RenderedVisitor>(double)> others = [](double) { return std::vector<RenderedVisitor>{}; };
  std::function<RenderedLight(double)> light = [](double) { return RenderedLight{}; };
  double noise_grey = 1.5;
};

/// Somebody in the background, who walks past and stops for a while.
inline RenderedVisitor passer_by(double t) {
  RenderedVisitor other;
  other.shirt_grey = 140.0f;
  other.height_m = 1.8;
  other.depth_m = 3.6;
  other.x_m = 2.8 - 0.45 * std::min(t - 5.0, 6.0) - 0.45 * std::max(0.0, t - 14.0);
  return other;
}

inline std::vector<VisitorStory> visitor_stories() {
  std::vector<VisitorStory> stories;
  const auto add = [&](const char* name) -> VisitorStory& {
    stories.push_back({});
    stories.back().name = name;
    return stories.back();
  };
  add("alone");
  auto& child = add("a child");
  child.visitor.looks.height_m = 1.2;
  child.visitor.looks.head_m = 0.145;
  child.visitor.looks.shirt_grey = 150.0f;
  auto& bright = add("a shirt as the wall");
  bright.visitor.looks.shirt_grey = 105.0f;
  bright.visitor.looks.height_m = 1.85;
  bright.visitor.looks.head_m = 0.165;
  add("somebody behind").others = [](double t) {
    return t < 5.0 ? std::vector<RenderedVisitor>{} : std::vector<RenderedVisitor>{passer_by(t)};
  };
  add("a lamp goes on and off").light = [](double t) {
    RenderedLight light;
    light.gain = t > 8.2 && t < 13.3 ? 1.25 : 1.0;
    light.lamp = t > 8.2 && t < 13.3 ? 0.3 : 0.0;
    return light;
  };
  add("the wall's light changes").light = [](double t) {
    RenderedLight light;
    light.gain = 0.8 + 0.2 * std::sin(1.7 * t);
    light.lamp = 0.3 + 0.3 * std::sin(0.8 * t);
    light.lamp_u = 0.5 + 0.3 * std::sin(0.5 * t);
    return light;
  };
  auto& dim = add("dim, and noisy");
  dim.light = [](double) {
    RenderedLight light;
    light.gain = 0.35;
    return light;
  };
  dim.noise_grey = 2.0;
  return stories;
}

}  // namespace cyclorama

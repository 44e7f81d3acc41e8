// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/balance/eye_path.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/panorama.h"

namespace cyclorama {
namespace {

Eigen::Vector3d forward(double heading_rad) { return {std::sin(heading_rad), 0.0, -std::cos(heading_rad)}; }

double usual_radius(const scene::SceneInfo& info, const Eigen::AlignedBox3d& bounds) {
  const Eigen::Vector3d eye = info.start_eye;
  if (bounds.contains(eye)) return 0.25 * std::min(bounds.sizes().x(), bounds.sizes().z());
  const Eigen::Vector3d to_middle = bounds.center() - eye;
  return std::hypot(to_middle.x(), to_middle.z());
}

}  // namespace

std::vector<EyePose> orbit(const scene::SceneInfo& info, const Eigen::AlignedBox3d& bounds,
                           const EyePathOptions& options) {
  const double radius = options.radius_m.value_or(usual_radius(info, bounds));
  const Eigen::Vector3d middle = info.start_eye + radius * forward(info.start_heading_rad);
  std::vector<EyePose> path;
  for (int i = 0; i < options.frames; ++i) {
    const double heading = info.start_heading_rad + i * options.step_rad;
    path.push_back({middle - radius * forward(heading), heading});
  }
  return path;
}

std::vector<EyePose> walk(const scene::SceneInfo& info, const EyePathOptions& options) {
  std::vector<EyePose> places{{info.start_eye, info.start_heading_rad}};
  for (const scene::SceneTourStop& stop : info.stops) places.push_back({stop.eye, stop.heading_rad});
  std::vector<EyePose> path{places.front()};
  std::size_t leg = 0;
  double along_m = 0.0;
  while (path.size() < static_cast<std::size_t>(options.frames)) {
    const EyePose& from = places[leg];
    const EyePose& to = places[(leg + 1) % places.size()];
    const double length = (to.eye - from.eye).norm();
    along_m = std::min(along_m + options.step_m, length);
    const double part = length > 0.0 ? along_m / length : 1.0;
    const double wanted = from.heading_rad + part * wrapped_angle(to.heading_rad - from.heading_rad);
    const double turn = wrapped_angle(wanted - path.back().heading_rad);
    path.push_back({from.eye + part * (to.eye - from.eye),
                    path.back().heading_rad + std::clamp(turn, -options.step_rad, options.step_rad)});
    if (part >= 1.0 && std::abs(turn) <= options.step_rad) {
      leg = (leg + 1) % places.size();
      along_m = 0.0;
    }
  }
  return path;
}

}  // namespace cyclorama

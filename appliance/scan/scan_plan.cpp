// SPDX-License-Identifier: Apache-2.0
#include "appliance/scan/scan_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "appliance/solve/turntable_cost.h"

namespace cyclorama::scan {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kColumns = 24;
constexpr int kRows = 14;
constexpr int kStep_deg = 2;  // Step between the headings that are tried.
constexpr int kMaxDirections = 36;
constexpr double kRim = 0.04;     // Fraction of the picture at each side that is not used.
constexpr double kBeyond = 0.03;  // Margin beyond the picture within which something may still be seen.
constexpr double kMinCoverage = 0.5;
constexpr double kMinUnremarkedShare = 0.98;

/// A direction in which the sweet spot sees a point that a projector lights.
struct DirectionSample {
  std::size_t projector;
  Eigen::Vector3d direction;
};

std::vector<DirectionSample> observations_of(const Installation& installation, std::vector<double>* ret_distances) {
  std::vector<DirectionSample> observations;
  for (std::size_t p = 0; p < installation.projectors.size(); ++p) {
    const InstalledProjector& projector = installation.projectors[p];
    for (int row = 0; row < kRows; ++row) {
      for (int column = 0; column < kColumns; ++column) {
        const Eigen::Vector3d ray = projector.lens.direction_at((column + 0.5) / kColumns * projector.lens.width_px,
                                                                (row + 0.5) / kRows * projector.lens.height_px);
        const auto at = hit(installation.wall,
                            {{projector.T_room_projector.translation()}, projector.T_room_projector.rotation() * ray});
        if (!at) continue;
        const Eigen::Vector3d from_eye = at->xyz - installation.sweet_spot.xyz;
        if (!(from_eye.norm() > 1e-6)) continue;
        observations.push_back({p, from_eye.normalized()});
        ret_distances->push_back(from_eye.norm());
      }
    }
  }
  return observations;
}

/// Returns whether a direction is in the camera's picture without its rim. `rim` is a fraction of the picture's size at
/// each side; a negative value extends the picture.
bool is_seen(const ScanPlanOptions& options, double angle_rad, const Eigen::Vector3d& direction, double rim) {
  const double mount[2] = {options.pitch_rad, 0.0};
  const double offset[2] = {0.0, 0.0};
  Eigen::Vector3d point;
  solve::to_camera(mount, offset, angle_rad, direction.data(), 0.0, point.data());
  const auto pixel = options.camera.pixel_of(point);
  if (!pixel) return false;
  const double u = pixel->x() / options.camera.width_px;
  const double v = pixel->y() / options.camera.height_px;
  return u >= rim && u <= 1.0 - rim && v >= rim && v <= 1.0 - rim;
}

using Seen = std::vector<char>;  // Indexed by sample.

std::size_t count_of(const Seen& seen) { return static_cast<std::size_t>(std::count(seen.begin(), seen.end(), 1)); }

/// Returns the overlap of two views as a fraction of the smaller view.
double overlap_of(const Seen& a, const Seen& b) {
  std::size_t both = 0;
  for (std::size_t i = 0; i < a.size(); ++i) both += static_cast<std::size_t>(a[i] != 0 && b[i] != 0);
  const std::size_t min = std::min(count_of(a), count_of(b));
  return min == 0 ? 0.0 : static_cast<double>(both) / static_cast<double>(min);
}

struct Choice {
  int first = 0;  ///< Index into the headings.
  int step = 0;
  int count = 0;
  std::size_t covered = 0;
  double overlap = 0.0;
};

/// Returns whether `a` is better: it covers more or, with equal coverage, is closer to the requested overlap.
bool is_better(const Choice& a, const Choice& b, double requested) {
  if (a.covered != b.covered) return a.covered > b.covered;
  return std::abs(a.overlap - requested) < std::abs(b.overlap - requested);
}

std::optional<Choice> best_of(const std::vector<Seen>& seen, int count, const ScanPlanOptions& options) {
  std::optional<Choice> best;
  const auto headings = static_cast<int>(seen.size());
  for (int step = 1; step * (count - 1) < headings; ++step) {
    for (int first = 0; first + step * (count - 1) < headings; ++first) {
      Choice choice{first, step, count, 0, 1.0};
      if (count_of(seen[static_cast<std::size_t>(first)]) == 0) continue;
      Seen together = seen[static_cast<std::size_t>(first)];
      for (int i = 1; i < count && choice.overlap >= options.min_overlap; ++i) {
        const Seen& next = seen[static_cast<std::size_t>(first + i * step)];
        choice.overlap =
            std::min(choice.overlap, overlap_of(seen[static_cast<std::size_t>(first + (i - 1) * step)], next));
        for (std::size_t k = 0; k < next.size(); ++k) together[k] = static_cast<char>(together[k] | next[k]);
      }
      if (choice.overlap < options.min_overlap) continue;
      choice.covered = count_of(together);
      if (!best || is_better(choice, *best, options.preferred_overlap)) best = choice;
    }
  }
  return best;
}

std::vector<double> headings_within(const turntable::TurnRange& range) {
  const double max = std::min(range.max_rad, std::numbers::pi);
  std::vector<double> headings;
  for (int degrees = -180; degrees <= 180; degrees += kStep_deg) {
    const double angle = degrees * kDegree;
    if (angle >= range.min_rad - 1e-9 && angle <= max + 1e-9) headings.push_back(angle);
  }
  return headings;
}

}  // namespace

Result<ScanPlan> plan_scan(const Installation& installation, const ScanPlanOptions& options) {
  std::vector<double> distances;
  const std::vector<DirectionSample> observations = observations_of(installation, &distances);
  if (observations.empty()) {
    return Error(ErrorCode::kInvalidArgument,
                 "by installation.toml no projector lights the wall; correct the projectors' places there");
  }
  const std::vector<double> headings = headings_within(options.range);
  std::vector<Seen> seen;
  Seen seeable(observations.size(), 0);
  for (const double heading : headings) {
    Seen& row = seen.emplace_back();
    for (std::size_t i = 0; i < observations.size(); ++i) {
      row.push_back(static_cast<char>(is_seen(options, heading, observations[i].direction, kRim)));
      seeable[i] = static_cast<char>(seeable[i] | row.back());
    }
  }
  const std::size_t all = count_of(seeable);
  if (static_cast<double>(all) < kMinCoverage * static_cast<double>(observations.size())) {
    return Error(
        ErrorCode::kInvalidArgument,
        fmt::format("in all directions together, the camera sees {:.0f} % of what is lit; give it a wider lens, "
                    "tilt it towards the middle of the wall, or correct its field of view and tilt",
                    100.0 * static_cast<double>(all) / static_cast<double>(observations.size())));
  }
  std::optional<Choice> chosen;
  const int fewest = options.directions > 0 ? options.directions : 2;
  const int max = options.directions > 0 ? options.directions : kMaxDirections;
  for (int count = fewest; count <= max; ++count) {
    const auto choice = best_of(seen, count, options);
    if (!choice) continue;
    if (!chosen || choice->covered > chosen->covered) chosen = choice;
    if (chosen->covered == all) break;
  }
  if (!chosen) {
    return Error(
        ErrorCode::kInvalidArgument,
        fmt::format("no {} directions within the turntable's {:.0f} to {:.0f} degrees overlap by {:.0f} %; allow "
                    "more directions, or give the camera a wider lens",
                    fewest, options.range.min_rad / kDegree, options.range.max_rad / kDegree,
                    100.0 * options.min_overlap));
  }

  ScanPlan plan;
  std::vector<std::size_t> lit(installation.projectors.size(), 0);
  std::vector<std::size_t> covered(installation.projectors.size(), 0);
  Seen together(observations.size(), 0);
  for (int i = 0; i < chosen->count; ++i) {
    const auto at = static_cast<std::size_t>(chosen->first + i * chosen->step);
    ScanDirection direction{headings[at], {}};
    std::vector<std::size_t> maybe(installation.projectors.size(), 0);
    for (std::size_t s = 0; s < observations.size(); ++s) {
      together[s] = static_cast<char>(together[s] | seen[at][s]);
      maybe[observations[s].projector] +=
          static_cast<std::size_t>(is_seen(options, headings[at], observations[s].direction, -kBeyond));
    }
    for (std::size_t p = 0; p < maybe.size(); ++p) {
      if (maybe[p] > 0) direction.projectors.push_back(p);
    }
    plan.directions.push_back(std::move(direction));
  }
  for (std::size_t s = 0; s < observations.size(); ++s) {
    ++lit[observations[s].projector];
    covered[observations[s].projector] += static_cast<std::size_t>(together[s] != 0);
  }
  for (std::size_t p = 0; p < lit.size(); ++p) {
    const std::string& name = installation.projectors[p].name;
    const double share = lit[p] == 0 ? 0.0 : static_cast<double>(covered[p]) / static_cast<double>(lit[p]);
    if (lit[p] == 0) {
      plan.remarks.push_back(
          fmt::format("by installation.toml projector '{}' misses the wall; correct its place", name));
    } else if (share < kMinUnremarkedShare) {
      plan.remarks.push_back(
          fmt::format("the camera will see {:.0f} % of what projector '{}' lights; give it a wider "
                      "lens, or tilt it",
                      100.0 * share, name));
    }
  }
  double sum = 0.0;
  double squares = 0.0;
  for (const double distance : distances) sum += distance;
  plan.wall_distance_m = sum / static_cast<double>(distances.size());
  for (const double distance : distances)
    squares += (distance - plan.wall_distance_m) * (distance - plan.wall_distance_m);
  // At least a tenth, since walls are not built exactly as drawn.
  plan.wall_distance_sigma_m =
      std::hypot(std::sqrt(squares / static_cast<double>(distances.size())), 0.1 * plan.wall_distance_m);
  return plan;
}

}  // namespace cyclorama::scan

// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/balance/cut_search.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

namespace cyclorama::balance {
namespace {

/// Additional cost per unit of aspect ratio, because long borders cost more in JPEG and caches.
constexpr double kPerAspect = 0.01;
constexpr double kFreeAspect = 2.0;
/// Number of forks below a cut that are evaluated with their best cuts.
constexpr int kForksAhead = 1;

using Speeds = std::span<const double>;

double sum_of(Speeds speeds) { return std::accumulate(speeds.begin(), speeds.end(), 0.0); }

double stretched(const CellRect& r) {
  const double aspect = static_cast<double>(std::max(r.width, r.height)) / std::min(r.width, r.height);
  return 1.0 + kPerAspect * std::max(0.0, aspect - kFreeAspect);
}

struct Cut {
  CutDirection direction = CutDirection::kAcross;
  int at = 0;
  double seconds = std::numeric_limits<double>::infinity();  ///< Time of the slower part.
};

class CutSearch {
 public:
  explicit CutSearch(const WorkSums& work) : work_(work) {}

  void cut(const CellRect& region, Speeds speeds, std::span<CellRect> ret) const {
    if (speeds.size() == 1) {
      ret[0] = region;
      return;
    }
    if (region.count() == 1) {
      ret[static_cast<std::size_t>(std::ranges::max_element(speeds) - speeds.begin())] = region;
      return;
    }
    const std::size_t left = speeds.size() / 2;
    const Cut best = best_cut(region, speeds, kForksAhead);
    cut(before_cut(region, best.direction, best.at), speeds.first(left), ret.first(left));
    cut(after_cut(region, best.direction, best.at), speeds.subspan(left), ret.subspan(left));
  }

 private:
  /// Precondition: there are at least two nodes and two cells.
  [[nodiscard]] Cut best_cut(const CellRect& region, Speeds speeds, int forks_ahead) const {
    const Speeds first = speeds.first(speeds.size() / 2);
    const Speeds second = speeds.subspan(first.size());
    const double first_speed = sum_of(first);
    const double second_speed = sum_of(second);
    const double all = work_.of(region);
    const double wanted = all * first_speed / (first_speed + second_speed);
    Cut best;
    for (const CutDirection d : {CutDirection::kAcross, CutDirection::kDown}) {
      if (length_of(region, d) < 2) continue;
      const int reaches = first_cut_with(work_, region, d, wanted);
      for (const int at : {reaches, reaches - 1}) {
        if (at < 1) continue;
        const CellRect before = before_cut(region, d, at);
        const double work = work_.of(before);
        // No cuts inside the parts can be faster than this bound.
        if (std::max(work / first_speed, (all - work) / second_speed) >= best.seconds) continue;
        const double seconds_before = seconds(before, first, forks_ahead);
        if (seconds_before >= best.seconds) continue;
        const double slowest = std::max(seconds_before, seconds(after_cut(region, d, at), second, forks_ahead));
        if (slowest < best.seconds) best = {d, at, slowest};
      }
    }
    return best;
  }

  /// Returns the time until the last of the nodes is done with the region.
  [[nodiscard]] double seconds(const CellRect& region, Speeds speeds, int forks_ahead) const {
    if (speeds.size() == 1 || region.count() == 1 || forks_ahead == 0) {
      return stretched(region) * work_.of(region) / sum_of(speeds);
    }
    return best_cut(region, speeds, forks_ahead - 1).seconds;
  }

  const WorkSums& work_;
};

}  // namespace

std::vector<CellRect> cut_for_nodes(const WorkSums& work, Speeds speeds) {
  std::vector<CellRect> parts(speeds.size());
  if (!speeds.empty() && !work.whole().empty()) CutSearch(work).cut(work.whole(), speeds, parts);
  return parts;
}

std::vector<CellRect> cut_by_shares(const WorkSums& work, const CellRect& region, std::span<const double> shares) {
  std::vector<CellRect> parts;
  CellRect rest = region;
  double left = std::accumulate(shares.begin(), shares.end(), 0.0);
  for (std::size_t i = 0; i + 1 < shares.size() && rest.count() > 1; ++i) {
    const CutDirection d = longer_side(rest);
    const int at = nearest_cut(work, rest, d, work.of(rest) * shares[i] / left);
    parts.push_back(before_cut(rest, d, at));
    rest = after_cut(rest, d, at);
    left -= shares[i];
  }
  parts.push_back(rest);
  return parts;
}

}  // namespace cyclorama::balance

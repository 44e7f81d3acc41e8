// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/estimator/exposure_timing.h"

#include <algorithm>
#include <optional>
#include <vector>

namespace cyclorama::healing {
namespace {

constexpr int kMinPatches = 10;
constexpr double kDiffers_px = 4.0;  // Distance counted for a patch that is not found: the reach of the search.
// Minimum differences between two times that count: above the effect of a slightly wrong pose and of noise.
constexpr double kBetter_px = 0.12;
constexpr double kBetterPart = 0.1;
constexpr double kWorse_px = 0.05;

/// Returns the mean distance of patches per projector; empty for projectors with too few comparable patches.
std::vector<std::optional<double>> mean_off_px(std::span<const PatchShift> patches, std::size_t projectors) {
  std::vector<double> sums(projectors, 0.0);
  std::vector<int> counts(projectors, 0);
  for (const PatchShift& patch : patches) {
    if (patch.projector < 0 || static_cast<std::size_t>(patch.projector) >= projectors) continue;
    if (patch.fit != PatchFit::kFits && patch.fit != PatchFit::kDiffers) continue;
    const auto projector = static_cast<std::size_t>(patch.projector);
    sums[projector] += patch.fit == PatchFit::kFits ? std::min(patch.shift.norm(), kDiffers_px) : kDiffers_px;
    ++counts[projector];
  }
  std::vector<std::optional<double>> means(projectors);
  for (std::size_t i = 0; i < projectors; ++i) {
    if (counts[i] >= kMinPatches) means[i] = sums[i] / counts[i];
  }
  return means;
}

}  // namespace

ExposureTiming estimate_timing(std::span<const PatchShift> said, std::span<const PatchShift> earlier,
                               std::span<const PatchShift> later, std::size_t projectors) {
  const auto now = mean_off_px(said, projectors);
  const auto before = mean_off_px(earlier, projectors);
  const auto after = mean_off_px(later, projectors);
  int own = 0;
  int to_before = 0;
  int to_after = 0;
  for (std::size_t i = 0; i < projectors; ++i) {
    if (!now[i]) continue;
    const double here = *now[i];
    const double less = before[i].value_or(kDiffers_px);
    const double more = after[i].value_or(kDiffers_px);
    if (std::min(less, more) < here - std::max(kBetter_px, kBetterPart * here)) {
      ++(less < more ? to_before : to_after);
    } else if (std::max(less, more) > here + kWorse_px) {
      ++own;
    }
  }
  ExposureTiming time;
  time.is_its_own = own > 0 && own >= to_before + to_after;
  if (own == 0 && to_before > 0 && to_after == 0) time.towards = -1;
  if (own == 0 && to_after > 0 && to_before == 0) time.towards = 1;
  return time;
}

}  // namespace cyclorama::healing

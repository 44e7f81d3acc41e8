// SPDX-License-Identifier: Apache-2.0
#include "appliance/healing/estimator/areas.h"

namespace cyclorama::healing {

void AreaMap::update(std::span<const PatchShift> patches) {
  doubts_.resize(patches.size(), 0.0f);
  fits_.resize(patches.size(), PatchFit::kShared);
  for (std::size_t i = 0; i < patches.size(); ++i) {
    fits_[i] = patches[i].fit;
    // A patch that cannot be compared gives no information: a person may still stand there.
    if (patches[i].fit == PatchFit::kFits) doubts_[i] += kGrowth * (0.0f - doubts_[i]);
    if (patches[i].fit == PatchFit::kDiffers) doubts_[i] += kGrowth * (1.0f - doubts_[i]);
  }
}

Area AreaMap::area(std::size_t patch) const {
  if (patch >= fits_.size()) return Area::kUnknown;
  if (doubts_[patch] > kInTheWayAbove) return Area::kInTheWay;
  switch (fits_[patch]) {
    case PatchFit::kFits:
    case PatchFit::kDiffers:
      return Area::kProjector;
    case PatchFit::kPlain:
      return Area::kPlain;
    case PatchFit::kShared:
      return Area::kShared;
  }
  return Area::kUnknown;
}

double AreaMap::hidden() const {
  int hidden = 0;
  int compared = 0;
  for (std::size_t i = 0; i < fits_.size(); ++i) {
    const Area what = area(i);
    hidden += what == Area::kInTheWay ? 1 : 0;
    compared += what == Area::kInTheWay || what == Area::kProjector ? 1 : 0;
  }
  return compared > 0 ? static_cast<double>(hidden) / compared : 0.0;
}

PatchTally& PatchTally::operator+=(const PatchTally& other) {
  fits += other.fits;
  differs += other.differs;
  plain += other.plain;
  faint += other.faint;
  return *this;
}

std::vector<PatchTally> tally(std::span<const PatchShift> patches, std::size_t projectors) {
  constexpr double kFaint = 0.2;
  std::vector<PatchTally> sums(projectors);
  for (const PatchShift& patch : patches) {
    if (patch.projector < 0) continue;
    PatchTally& sum = sums[static_cast<std::size_t>(patch.projector)];
    switch (patch.fit) {
      case PatchFit::kFits:
        ++sum.fits;
        break;
      case PatchFit::kDiffers:
        ++sum.differs;
        if (patch.contrast < kFaint) ++sum.faint;
        break;
      case PatchFit::kPlain:
        ++sum.plain;
        break;
      case PatchFit::kShared:
        break;
    }
  }
  return sums;
}

}  // namespace cyclorama::healing
